// What the tests of image files share.
#pragma once

#include <string>
#include <utility>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/io_fixture.h"

namespace anatomesh::testing {

/// A test of image files.
class ImageFileTest : public IoTest {
 protected:
  ImageFile image_in(const std::string& name, const std::string& bytes) const {
    return read_label_image(put(name, bytes));
  }

  /// The message about a file of these bytes, which cannot be read.
  template <typename Expected>
  std::string refused(const std::string& name, const std::string& bytes) const {
    const auto file = put(name, bytes);
    return message_of<Expected>(file, [&] { read_label_image(file); });
  }
};

/// A test of images that are made byte by byte: Made::file() are the bytes.
template <typename Made>
class MadeImageTest : public ImageFileTest {
 protected:
  explicit MadeImageTest(std::string name) : name_(std::move(name)) {}

  ImageFile read(const Made& made) const { return image_in(name_, made.file()); }

  template <typename Expected>
  std::string refused(const Made& made) const {
    return ImageFileTest::refused<Expected>(name_, made.file());
  }

 private:
  std::string name_;
};

/// Fails unless there is one note about the image, and returns it.
std::string only_note(const ImageFile& file);

void expect_near(Vec3 actual, Vec3 expected, double tolerance);
void expect_near(const Mat3& actual, const Mat3& expected, double tolerance);

}  // namespace anatomesh::testing
