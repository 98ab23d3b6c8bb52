// A DICOM series with one damaged slice. On some of these GDCM aborts.
#include <gtest/gtest.h>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/damage.h"
#include "io/dicom_slice.h"
#include "io/io_fixture.h"

namespace anatomesh::testing {
namespace {

class DicomDamage : public IoTest {
 protected:
  DicomDamage() {
    for (const int n : {0, 1, 2, 3}) put(std::to_string(n) + ".dcm", slice(n));
  }

  static std::string slice(int n) {
    DicomSlice result;
    result.number = n + 1;
    result.position[2] = 30 + 2 * n;
    return result.file();
  }

  /// Whether it is an image; else it was refused.
  bool is_read_with(const std::string& bytes) const {
    put("1.dcm", bytes);
    try {
      const LabelImage image = read_label_image(in_folder("")).image;
      EXPECT_EQ(image.voxels.size(), image.size[0] * image.size[1] * image.size[2]);
      return true;
    } catch (const Error& error) {
      EXPECT_SAYS(std::string(error.what()), in_folder("").parent_path().filename().string());
      return false;
    }
  }
};

TEST_F(DicomDamage, CutAnywhereIsRefused) {
  const std::string whole = slice(1);
  ASSERT_TRUE(is_read_with(whole));
  for (std::size_t length = 0; length < whole.size(); length += length < 120 ? 40 : 1) {
    EXPECT_FALSE(is_read_with(whole.substr(0, length))) << length << " of " << whole.size();
  }
}

TEST_F(DicomDamage, AnyIsReadOrRefused) {
  std::mt19937 random(5);
  const std::string whole = slice(1);
  for (int trial = 0; trial < 400; ++trial) is_read_with(damaged(whole, random));
}

TEST_F(DicomDamage, SingleFilesAreReadOrRefused) {
  std::mt19937 random(7);
  const std::string whole = slice(1);
  for (int trial = 0; trial < 200; ++trial) {
    const auto file = put("1.dcm", damaged(whole, random).substr(0, trial < 20 ? 10 * trial : std::string::npos));
    EXPECT_THROW(read_label_image(file), Error);  // one slice is no volume
  }
}

}  // namespace
}  // namespace anatomesh::testing
