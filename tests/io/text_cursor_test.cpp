#include "io/text_cursor.h"

#include <gtest/gtest.h>

#include "anatomesh/errors.h"

namespace anatomesh::testing {
namespace {

TEST(TextCursor, WordsLinesAndNumbers) {
  TextCursor text("a file", "one  two\r\n 3 4.5e-1 +6\nrest of it\n\nend");
  EXPECT_EQ(text.word(), "one");
  EXPECT_EQ(text.line(), "  two");
  EXPECT_EQ(text.number<int>(), 3);
  EXPECT_FALSE(text.at_line_end());
  EXPECT_EQ(text.number<double>(), 0.45);
  EXPECT_EQ(text.number<int>(), 6);
  EXPECT_TRUE(text.at_line_end());
  EXPECT_EQ(text.line(), "");
  EXPECT_EQ(text.take(4), "rest");
  EXPECT_EQ(text.line(), " of it");
  EXPECT_EQ(text.word(), "end");
  EXPECT_TRUE(text.at_end());
  EXPECT_EQ(text.word(), "");
  EXPECT_EQ(text.line(), "");
}

TEST(TextCursor, ErrorsSayWhere) {
  const auto message = [](const auto& act) {
    TextCursor text("a file", "first\nsecond x9\n99999999999 3");
    text.line();
    text.word();
    try {
      act(text);
    } catch (const IoError& error) {
      return std::string(error.what());
    }
    return std::string("no error");
  };
  EXPECT_EQ(message([](TextCursor& t) { t.number<int>(); }),
            "'a file' is truncated or damaged: line 2: 'x9' stands where a number should");
  const auto third = [](TextCursor& t) {
    t.line();
    t.number<int>();
  };
  EXPECT_NE(message(third).find("line 3: '99999999999'"), std::string::npos);
  const auto too_many = [](TextCursor& t) {
    t.line();
    t.count_of(2);
  };
  EXPECT_NE(message(too_many).find("ends too early"), std::string::npos);
  EXPECT_NE(message([](TextCursor& t) { t.take(100); }).find("ends too early"), std::string::npos);
}

TEST(TextCursor, MissingFile) { EXPECT_THROW(TextCursor("/no/such/file"), IoError); }

}  // namespace
}  // namespace anatomesh::testing
