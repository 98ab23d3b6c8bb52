#include "io/dicom_slice.h"

#include <cstring>
#include <sstream>

#include "io/dicom_bytes.h"

namespace anatomesh::testing {
namespace {

template <typename Numbers>
std::string listed(const Numbers& numbers) {
  std::ostringstream text;
  const char* separator = "";
  for (const double number : numbers) {
    text << separator << number;
    separator = "\\";
  }
  return text.str();
}

}  // namespace

std::string DicomSlice::file() const {
  const std::string kind = "1.2.840.10008.5.1.4.1.1.2";  // CT image
  const std::string uid = series_uid + ".1." + std::to_string(number);
  const std::string meta = long_dicom_element(2, 1, "OB", std::string("\0\1", 2)) + dicom_element(2, 2, "UI", kind) +
                           dicom_element(2, 3, "UI", uid) + dicom_element(2, 0x10, "UI", "1.2.840.10008.1.2.1") +
                           dicom_element(2, 0x12, "UI", "1.2.3");
  std::string pixels(voxels.size() * 2, '\0');
  std::memcpy(pixels.data(), voxels.data(), pixels.size());
  return std::string(128, '\0') + "DICM" + dicom_element(2, 0, "UL", dicom_u32(meta.size())) + meta +
         dicom_element(8, 0x16, "UI", kind) + dicom_element(8, 0x18, "UI", uid) +
         dicom_element(8, 0x60, "CS", modality) + dicom_element(0x18, 0x50, "DS", "2") +
         dicom_element(0x20, 0xd, "UI", "1.2.3") + dicom_element(0x20, 0xe, "UI", series_uid) +
         dicom_element(0x20, 0x13, "IS", std::to_string(number)) + dicom_element(0x20, 0x32, "DS", listed(position)) +
         dicom_element(0x20, 0x37, "DS", listed(orientation)) + dicom_element(0x28, 2, "US", dicom_u16(1)) +
         dicom_element(0x28, 4, "CS", "MONOCHROME2") +
         dicom_element(0x28, 0x10, "US", dicom_u16(static_cast<std::size_t>(rows))) +
         dicom_element(0x28, 0x11, "US", dicom_u16(static_cast<std::size_t>(columns))) +
         dicom_element(0x28, 0x30, "DS", "0.5\\0.25") + dicom_element(0x28, 0x100, "US", dicom_u16(16)) +
         dicom_element(0x28, 0x101, "US", dicom_u16(16)) + dicom_element(0x28, 0x102, "US", dicom_u16(15)) +
         dicom_element(0x28, 0x103, "US", dicom_u16(0)) + long_dicom_element(0x7fe0, 0x10, "OW", pixels);
}

}  // namespace anatomesh::testing
