// DICOM files made byte by byte.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace anatomesh::testing {

/// One slice of a series: 3 rows of 4 unsigned 16-bit voxels, 0.5 mm (down) by 0.25 mm (across).
struct DicomSlice {
  std::string series_uid = "1.2.3.4";
  std::string modality = "CT";
  int number = 1;
  std::array<double, 3> position = {10, 20, 30};  ///< of the first voxel, LPS mm
  std::array<double, 6> orientation = {1, 0, 0, 0, 1, 0};
  int rows = 3, columns = 4;
  std::vector<std::uint16_t> voxels = std::vector<std::uint16_t>(12);

  /// The file: explicit little endian, secondary fields as few as readers allow.
  std::string file() const;
};

}  // namespace anatomesh::testing
