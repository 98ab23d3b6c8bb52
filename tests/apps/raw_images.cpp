#include "apps/raw_images.h"

#include <algorithm>
#include <cstring>
#include <sstream>

namespace anatomesh::testing {

std::string Nrrd::file() const {
  std::ostringstream text;
  const auto dimension = 1 + std::count(sizes.begin(), sizes.end(), ' ');
  text << "NRRD0004\ntype: " << type << "\ndimension: " << dimension
       << "\nspace: left-posterior-superior\nsizes: " << sizes << "\nspace directions: " << directions
       << "\nkinds: " << kinds << "\nendian: little\nencoding: raw\nspace origin: (0,0,0)\n\n"
       << data;
  return text.str();
}

std::string MetaImage::file() const {
  std::ostringstream text;
  text << "ObjectType = Image\nNDims = 3\nBinaryData = True\nBinaryDataByteOrderMSB = False\nCompressedData = False\n"
       << "TransformMatrix = 1 0 0 0 1 0 0 0 1\nOffset = 0 0 0\nElementSpacing = " << spacing << "\nDimSize = " << size
       << "\nElementNumberOfChannels = " << channels << "\nElementType = MET_UCHAR\nElementDataFile = " << data_file
       << "\n"
       << (data_file == "LOCAL" ? data : "");
  return text.str();
}

std::string Nifti::file() const {
  std::string header(352, '\0');
  const auto put = [&](std::size_t offset, const auto& value) { std::memcpy(&header[offset], &value, sizeof(value)); };
  put(0, std::int32_t{348});
  put(40, dim);
  put(70, std::int16_t{2});  // datatype: unsigned char
  put(72, std::int16_t{8});  // bits a voxel
  put(76, pixdim);
  put(108, 352.0F);           // offset of the voxels
  put(123, char{2});          // unit: mm
  put(252, std::int16_t{1});  // qform: scanner
  put(344, std::array<char, 4>{'n', '+', '1', '\0'});
  return header + data;
}

}  // namespace anatomesh::testing
