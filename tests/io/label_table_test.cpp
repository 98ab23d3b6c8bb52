#include "anatomesh/label_table.h"

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/io_fixture.h"
#include "io/utf8.h"

namespace anatomesh::testing {
namespace {

class LabelTables : public IoTest {
 protected:
  LabelTable read(std::string_view text) const { return read_label_table(put("table", text)); }

  std::string message(std::string_view text) const {
    const auto file = put("table", text);
    return message_of<InvalidInput>(file, [&] { read_label_table(file); });
  }
};

const LabelTable kThree = {{0, {"Background", Colour{0, 0, 0}}},
                           {2, {"left kidney", Colour{185, 102, 83}}},
                           {70000, {"Leber", Colour{221, 130, 101}}}};

TEST_F(LabelTables, OfSlicer) {
  EXPECT_EQ(read("# Color table file /somewhere/names.ctbl\r\n# 3 values\r\n0 Background 0 0 0 0\r\n"
                 "2 left_kidney 185 102.2 83 255\r\n\r\n70000 Leber 221 130 101 255\r\n"),
            kThree);
}

TEST_F(LabelTables, OfFreeSurferKeepsUnderscores) {
  const LabelTable table = read(
      "#$Id: FreeSurferColorLUT.txt,v 1.0\n#No. Label Name:      R   G   B   A\n\n"
      "4   Left-Lateral-Ventricle        120 18  134 0\n"
      "251 CC_Posterior                  0   0   64  0   # a comment\n"
      "1001\tctx-lh-bankssts\t\t25\t100\t40\t0\n");
  EXPECT_EQ(table, (LabelTable{{4, {"Left-Lateral-Ventricle", Colour{120, 18, 134}}},
                               {251, {"CC_Posterior", Colour{0, 0, 64}}},
                               {1001, {"ctx-lh-bankssts", Colour{25, 100, 40}}}}));
}

TEST_F(LabelTables, OfItkSnap) {
  EXPECT_EQ(read("################\n# ITK-SnAP Label Description File\n# IDX   -R-  -G-  -B-  -A--  VIS MSH  LABEL\n"
                 "    0     0    0    0        0  0  0    \"Background\"\n"
                 "    2   185  102   83        1  1  0    \"left kidney\"\n"
                 "70000   221  130  101     0.50  0  1    \"Leber\"\n"),
            kThree);
}

TEST_F(LabelTables, Lists) {
  const LabelTable bare = {{1, {"grey matter", {}}}, {2, {"white, deep", {}}}};
  EXPECT_EQ(read("1,grey matter\n2,\"white, deep\"\n"), bare);
  EXPECT_EQ(read("1;grey matter\n2;white, deep\n"), bare);
  EXPECT_EQ(read("1\tgrey matter\n2\twhite, deep"), bare);
  EXPECT_EQ(read("label,name,,\n1,grey matter,,\n2,\"white, deep\",,\n"), bare);
  EXPECT_EQ(read("index\tname\tabbreviation\n1\tgrey matter\tGM\n2\twhite, deep\tWM\n"), bare);
  EXPECT_EQ(read("1 \"grey matter\"\n2 \"white, deep\"\n"), bare);
  EXPECT_EQ(read("0,Background,0,0,0\n2,left kidney,185,102,83\n70000,Leber,221,130,101\n"), kThree);
  EXPECT_EQ(read("1,the \"\n\n# none\n").at(1).name, "the \"");
  EXPECT_EQ(read("1,\"the \"\"left\"\" one\"\n").at(1).name, "the \"left\" one");
}

TEST_F(LabelTables, TitlesSayWhichColumnIsWhich) {
  EXPECT_EQ(read("\xef\xbb\xbfLabelValue,Name,Color_R,Color_G,Color_B,Color_A,Category_CodingScheme\n"
                 "0,Background,0,0,0,0,\n2,left kidney,185,102,83,255,SCT\n70000,Leber,221,130,101,255,SCT\n"),
            kThree);
  EXPECT_EQ(read("B,G,R,label,ID\n0,0,0,Background,0\n83,102,185,left kidney,2\n101,130,221,Leber,70000\n"), kThree);
}

TEST_F(LabelTables, TheSameLineTwiceIsNoContradiction) {
  EXPECT_EQ(read("1,a\n1,a\n").size(), 1U);
  const std::string said = message("1,a\n2,b\n1,c\n");
  EXPECT_SAYS(said, "line 3");
  EXPECT_SAYS(said, "label 1 again, otherwise than line 1");
}

TEST_F(LabelTables, BadLinesAreNamed) {
  struct Case {
    std::string_view text;
    std::vector<std::string> said;
  };
  const std::vector<Case> cases = {
      {"1 white matter 2 3 4 5\n", {"line 1", "index name red green blue alpha", "quotes"}},
      {"1 a 0 0 0 0\n2 white matter 0 0 0 0\n", {"line 2", "7 fields", "_ for spaces"}},
      {"1 a 0 0 0 0\n2 b 0 0\n", {"line 2", "4 fields"}},
      {"1 a 0 0 256 0\n", {"line 1", "'256'", "0 to 255"}},
      {"1 a 0 nan 0 0\n", {"line 1", "'nan'", "0 to 255"}},
      {"1\n", {"line 1", "no name"}},
      {"-1,a\n", {"line 1", "'-1'", "0 to 4294967295"}},
      {"1,a\n4294967296,b\n", {"line 2", "'4294967296'"}},
      {"1,a\n2.5,b\n", {"line 2", "'2.5'"}},
      {"1,a,255\n", {"line 1", "3 fields", "label,name,red,green,blue"}},
      {"1,a,0,0,0,0,0\n", {"line 1", "7 fields"}},
      {"1,\"a\n", {"line 1", "not closed"}},
      {"1,\"a\"b\n", {"line 1", "'b'", "behind a quotation mark"}},
      {"0 1 2 3 1 1 1 \"a\"\n1 2 3 4 1 1 \"b\"\n", {"line 2", "no name", "opacity"}},
      {"tissue;code\nliver;1\n", {"line 1", "'tissue'", "label,name"}},
      {"# only comments\n\n", {"names no label"}},
      {std::string_view("1,\0a\n", 5), {"line 1", "UTF-8"}},
      {"1,Gro\xdf"
       "e Vene\n",
       {"line 1", "UTF-8"}},
      {"NRRD0004\ntype: uint8\n", {"line 1", "'NRRD0004'"}},
  };
  for (const Case& c : cases) {
    const std::string said = message(c.text);
    for (const std::string& part : c.said) EXPECT_SAYS(said, part);
    EXPECT_EQ(said.find('\n'), std::string::npos) << said;
  }
}

TEST_F(LabelTables, FilesThatAreNone) {
  EXPECT_THROW(read_label_table(in_folder("missing.txt")), IoError);
  EXPECT_THROW(read_label_table(put("empty.txt", "")), IoError);
  const auto folder = in_folder("");
  EXPECT_THROW(read_label_table(folder), InvalidInput);
  const auto large = put("large.txt", "1,a\n");
  std::filesystem::resize_file(large, std::uintmax_t{1} << 40);
  EXPECT_SAYS(message_of<InvalidInput>(large, [&] { read_label_table(large); }), "bytes");
}

TEST_F(LabelTables, AnyBytesGiveATableOrAnError) {
  const std::string good = "1,\"left kidney\",1,2,3\n\"2\";b\t3 # \xc3\xa4\n";
  for (std::size_t at = 0; at < good.size(); ++at) {
    for (const char c : {'\0', '"', ',', '\n', '#', ' ', '\xff', '9'}) {
      std::string text = good;
      text[at] = c;
      try {
        read(text);
      } catch (const InvalidInput&) {
      }
    }
  }
}

TEST(Utf8, Lines) {
  for (const char* good : {"", "plain\ttext", "Gro\xc3\x9f", "\xe2\x82\xac", "\xf0\x9f\xab\x80"})
    EXPECT_TRUE(is_one_line_of_utf8(good)) << good;
  for (const char* bad : {"\x1b[1m", "a\nb", "\xc3", "\xc0\xaf", "\xed\xa0\x80", "\xf5\x80\x80\x80", "\x80", "\x7f"})
    EXPECT_FALSE(is_one_line_of_utf8(bad)) << bad;
}

}  // namespace
}  // namespace anatomesh::testing
