#include "io/base64.h"

#include <gtest/gtest.h>

namespace anatomesh::testing {
namespace {

TEST(Base64, TheExamplesOfItsStandard) {
  EXPECT_EQ(base64_decoded(""), "");
  EXPECT_EQ(base64_decoded("Zg=="), "f");
  EXPECT_EQ(base64_decoded("Zm8="), "fo");
  EXPECT_EQ(base64_decoded("Zm9v"), "foo");
  EXPECT_EQ(base64_decoded("Zm9vYg=="), "foob");
  EXPECT_EQ(base64_decoded("+/+/"), "\xfb\xff\xbf");
}

TEST(Base64, PiecesAndWhiteSpace) {
  EXPECT_EQ(base64_decoded("Zg==Zm8="), "ffo");
  EXPECT_EQ(base64_decoded("\n  Zm\t9v\r\n"), "foo");
}

TEST(Base64, WhatIsNone) {
  for (const char* text : {"Z", "Zm9", "Zg=", "Z===", "====", "Zg=v", "Zm9*", "Zm9v_"}) {
    EXPECT_FALSE(base64_decoded(text)) << text;
  }
}

}  // namespace
}  // namespace anatomesh::testing
