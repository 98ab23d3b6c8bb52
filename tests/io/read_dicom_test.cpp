#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/dicom_slice.h"
#include "io/io_fixture.h"

namespace anatomesh::testing {
namespace {

class ReadDicom : public IoTest {
 protected:
  /// Slices 2 mm apart along z, in files whose names sort the other way round. Voxel 5 is 1000 + its number.
  void put_series(int count, const std::string& uid = "1.2.3.4", const std::string& prefix = "slice") const {
    for (int n = 0; n < count; ++n) put(prefix + std::to_string(9 - n) + ".dcm", slice(n, uid).file());
  }

  static DicomSlice slice(int n, const std::string& uid = "1.2.3.4") {
    DicomSlice result;
    result.series_uid = uid;
    result.number = n + 1;
    result.position[2] = 30 + 2 * n;
    result.voxels[5] = static_cast<std::uint16_t>(1000 + n);
    return result;
  }

  std::string refused() const {
    return message_of<InvalidInput>(in_folder("").parent_path(), [&] { read_label_image(in_folder("")); });
  }
};

TEST_F(ReadDicom, SeriesInAFolder) {
  put_series(4);
  const LabelImage image = read_label_image(in_folder("")).image;
  EXPECT_EQ(image.size, (std::array<std::size_t, 3>{4, 3, 4}));
  EXPECT_EQ(image.spacing_mm, (Vec3{0.25, 0.5, 2}));
  EXPECT_EQ(image.origin_mm, (Vec3{10, 20, 30}));
  EXPECT_EQ(image.direction, kIdentity3);
  for (std::size_t k = 0; k < 4; ++k) EXPECT_EQ(image.at(1, 1, k), 1000 + k);
}

TEST_F(ReadDicom, ObliqueSeries) {
  for (int n = 0; n < 3; ++n) {
    DicomSlice s = slice(n);
    s.orientation = {0, 1, 0, 0, 0, 1};  // sagittal: slices go along x
    s.position = {10 + 3.0 * n, 20, 30};
    put(std::to_string(n) + ".dcm", s.file());
  }
  const LabelImage image = read_label_image(in_folder("")).image;
  EXPECT_EQ(image.direction, (Mat3{{{0, 0, 1}, {1, 0, 0}, {0, 1, 0}}}));
  EXPECT_NEAR(image.spacing_mm.z, 3, 1e-12);
}

TEST_F(ReadDicom, TwoSeriesAreListed) {
  put_series(2);
  put_series(3, "1.2.3.5", "other");
  const std::string message = refused();
  EXPECT_SAYS(message, "1.2.3.4");
  EXPECT_SAYS(message, "1.2.3.5");
  EXPECT_SAYS(message, "3 files");
}

TEST_F(ReadDicom, FolderWithoutSeries) {
  EXPECT_SAYS(refused(), "no DICOM series");
  put("notes.txt", "nothing of the kind");
  EXPECT_SAYS(refused(), "no DICOM series");
  put("timezone", "Etc/UTC\n");  // GDCM aborts on a file of this length
  EXPECT_SAYS(refused(), "no DICOM series");
}

TEST_F(ReadDicom, MissingSliceIsNoticed) {
  put_series(5);
  std::filesystem::remove(in_folder("slice7.dcm"));
  EXPECT_SAYS(refused(), "a slice may be missing");
}

TEST_F(ReadDicom, SliceOfAnotherSizeIsNoticed) {
  put_series(3);
  DicomSlice odd = slice(3);
  odd.rows = 4, odd.columns = 3;
  const auto file = put("odd.dcm", odd.file());
  message_of<InvalidInput>(file, [&] { read_label_image(in_folder("")); });
}

TEST_F(ReadDicom, SingleSliceIsNoVolume) {
  put_series(1);
  EXPECT_SAYS(refused(), "single slice");
  const auto file = in_folder("slice9.dcm");
  EXPECT_SAYS(message_of<InvalidInput>(file, [&] { read_label_image(file); }), "give the folder");
}

TEST_F(ReadDicom, SegmentationObjectsAreRefused) {
  DicomSlice masks = slice(0);
  masks.modality = "SEG";
  const auto file = put("masks.dcm", masks.file());
  EXPECT_SAYS(message_of<InvalidInput>(file, [&] { read_label_image(file); }), "segmentation object");
}

TEST_F(ReadDicom, TruncatedSlice) {
  put_series(3);
  const std::string whole = slice(3).file();
  const auto file = put("slice1.dcm", whole.substr(0, whole.size() - 5));
  message_of<IoError>(file, [&] { read_label_image(in_folder("")); });
}

}  // namespace
}  // namespace anatomesh::testing
