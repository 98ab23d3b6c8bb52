// The header of NIfTI-1 and Analyze 7.5 files, and where it says that the image lies.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "io/image_geometry.h"

namespace anatomesh {

/// Fields of the 348 bytes in the names of the format's own definition (nifti1.h), byte order mended.
struct NiftiHeader {
  std::array<int, 8> dim = {};
  std::array<double, 8> pixdim = {};
  int datatype = 0;
  double vox_offset = 0;
  double scl_slope = 0, scl_inter = 0;
  int xyzt_units = 0;
  int qform_code = 0, sform_code = 0;
  std::array<double, 3> quatern = {};  ///< b, c, d
  std::array<double, 3> qoffset = {};
  std::array<std::array<double, 4>, 3> srow = {};
  bool is_nifti = false;        ///< false: Analyze 7.5, whose header has the same size
  bool is_single_file = false;  ///< the voxels follow the header in the same file
  bool is_swapped = false;      ///< the file's byte order is not this machine's

  std::array<std::size_t, 3> size() const;  ///< voxels along i, j, k
};

/// Whether the file begins with the size of such a header, after decompression if need be.
bool is_nifti_file(const std::filesystem::path& path);

/// Reads the header of a .nii, .hdr or .img file, compressed or not. Throws IoError where it is missing
/// or truncated, InvalidInput where it is none.
NiftiHeader read_nifti_header(const std::filesystem::path& path);

/// A geometry and what to tell the user about the choice.
struct NiftiGeometry {
  ImageGeometry geometry;
  std::vector<std::string> notes;
};

/// The sform where its code is > 0 and it is a rotation, possibly with a reflection, times a spacing; else the
/// qform where its code is > 0; else, as ITK does, the identity in LPS. In LPS mm. Not checked.
NiftiGeometry nifti_geometry(const std::filesystem::path& path, const NiftiHeader& header);

}  // namespace anatomesh
