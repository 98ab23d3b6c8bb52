// Image files byte by byte, so that they can be wrong in ways that no image library would write.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace anatomesh::testing {

/// The bytes of the values, one after the other, as this machine holds them.
template <class T>
std::string bytes_of(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// An NRRD file; the defaults are a good image of 4 x 4 x 4 voxels.
struct Nrrd {
  std::string type = "uint8";
  std::string sizes = "4 4 4";
  std::string directions = "(1,0,0) (0,1,0) (0,0,1)";
  std::string kinds = "domain domain domain";
  std::string data = std::string(64, '\1');

  std::string file() const;
};

/// A MetaImage file; the defaults are a good image of 4 x 4 x 4 voxels.
struct MetaImage {
  std::string spacing = "1 1 1";
  std::string size = "4 4 4";
  std::string channels = "1";
  std::string data_file = "LOCAL";  ///< or the name of a file with the voxels
  std::string data = std::string(64, '\1');

  std::string file() const;
};

/// A NIfTI-1 file of 8-bit voxels.
struct Nifti {
  std::array<std::int16_t, 8> dim = {3, 4, 4, 4, 1, 1, 1, 1};
  std::array<float, 8> pixdim = {1, 1, 1, 1, 1, 1, 1, 1};
  std::string data = std::string(64, '\1');

  std::string file() const;
};

}  // namespace anatomesh::testing
