#include "io/label_comment.h"

#include <gtest/gtest.h>

namespace anatomesh::testing {
namespace {

TEST(LabelComment, ComesBack) {
  TetMesh mesh;
  mesh.names[7].name = " White: \"matter\"\n";
  const auto comments = label_comments(mesh, {{7, "White"}, {9, "label_9"}});
  ASSERT_EQ(comments.size(), 2U);
  EXPECT_EQ(text_of(comments[0]), "label 7 is White: White: \"matter\"");
  EXPECT_EQ(text_of(comments[1]), "label 9 is label_9");
  const auto read = label_comment_in(std::string(1, ' ').append(text_of(comments[0])).append(1, '\r'));
  ASSERT_TRUE(read);
  EXPECT_EQ(read->label, 7U);
  EXPECT_EQ(read->set, "White");
  EXPECT_EQ(read->name, "White: \"matter\"");
  LabelTable names;
  add_name(*label_comment_in(text_of(comments[1])), names);
  EXPECT_TRUE(names.empty());
}

TEST(LabelComment, OthersAreNone) {
  for (const char* text : {"", "label", "label x is y", "label 4294967296 is y", "label 7 was y", "a label 7 is y"}) {
    EXPECT_FALSE(label_comment_in(text)) << text;
  }
}

}  // namespace
}  // namespace anatomesh::testing
