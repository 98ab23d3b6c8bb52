// NIfTI-1 files made byte by byte, so that they can be wrong in every way.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

namespace anatomesh::testing {

/// A NIfTI-1 file in the terms of the format's definition. As made: 4 x 3 x 2 voxels of 8 bits, all 0,
/// spacing 1 x 2 x 3 mm, a qform and an sform that agree: identity in RAS, origin (10, 20, 30).
struct NiftiBytes {
  std::array<std::int16_t, 8> dim = {3, 4, 3, 2, 1, 1, 1, 1};
  std::int16_t intent_code = 0;
  std::int16_t datatype = 2;  ///< unsigned 8 bits
  std::int16_t bitpix = 8;
  std::array<float, 8> pixdim = {1, 1, 2, 3, 0, 0, 0, 0};
  float scl_slope = 0, scl_inter = 0;
  char xyzt_units = 2;  ///< mm
  std::int16_t qform_code = 1, sform_code = 1;
  std::array<float, 3> quatern = {0, 0, 0};
  std::array<float, 3> qoffset = {10, 20, 30};
  std::array<std::array<float, 4>, 3> srow = {{{1, 0, 0, 10}, {0, 2, 0, 20}, {0, 0, 3, 30}}};
  std::string magic = std::string("n+1\0", 4);
  std::string voxels = std::string(24, '\0');

  /// Takes voxels of another type; code is the datatype's number.
  template <typename Value>
  void set_voxels(std::int16_t code, const std::vector<Value>& values) {
    datatype = code;
    bitpix = static_cast<std::int16_t>(8 * sizeof(Value));
    voxels.assign(values.size() * sizeof(Value), '\0');
    std::memcpy(voxels.data(), values.data(), voxels.size());
  }

  /// The 348 bytes of the header; in the other byte order with swapped.
  std::string header(bool swapped = false) const;

  /// The whole .nii file.
  std::string file() const { return header() + std::string(4, '\0') + voxels; }
};

}  // namespace anatomesh::testing
