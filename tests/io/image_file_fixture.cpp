#include "io/image_file_fixture.h"

namespace anatomesh::testing {

std::string only_note(const ImageFile& file) {
  EXPECT_EQ(file.notes.size(), 1U);
  return file.notes.empty() ? "" : file.notes[0];
}

void expect_near(Vec3 actual, Vec3 expected, double tolerance) {
  for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(actual[axis], expected[axis], tolerance) << "axis " << axis;
}

void expect_near(const Mat3& actual, const Mat3& expected, double tolerance) {
  for (std::size_t row = 0; row < 3; ++row) {
    for (std::size_t column = 0; column < 3; ++column) {
      EXPECT_NEAR(actual[row][column], expected[row][column], tolerance) << row << ", " << column;
    }
  }
}

}  // namespace anatomesh::testing
