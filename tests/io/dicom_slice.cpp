#include "io/dicom_slice.h"

#include <cstring>
#include <sstream>

namespace anatomesh::testing {
namespace {

std::string u16(std::size_t number) { return {static_cast<char>(number & 255), static_cast<char>(number >> 8 & 255)}; }

std::string u32(std::size_t number) { return u16(number & 65535) + u16(number >> 16); }

/// One data element with a short length; text is padded to an even length.
std::string element(std::uint16_t group, std::uint16_t tag, const std::string& type, std::string value) {
  if (value.size() % 2 != 0) value += type == "UI" ? '\0' : ' ';
  return u16(group) + u16(tag) + type + u16(value.size()) + value;
}

/// One data element with a long length.
std::string long_element(std::uint16_t group, std::uint16_t tag, const std::string& type, const std::string& value) {
  return u16(group) + u16(tag) + type + u16(0) + u32(value.size()) + value;
}

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
  const std::string meta = long_element(2, 1, "OB", std::string("\0\1", 2)) + element(2, 2, "UI", kind) +
                           element(2, 3, "UI", uid) + element(2, 0x10, "UI", "1.2.840.10008.1.2.1") +
                           element(2, 0x12, "UI", "1.2.3");
  std::string pixels(voxels.size() * 2, '\0');
  std::memcpy(pixels.data(), voxels.data(), pixels.size());
  return std::string(128, '\0') + "DICM" + element(2, 0, "UL", u32(meta.size())) + meta + element(8, 0x16, "UI", kind) +
         element(8, 0x18, "UI", uid) + element(8, 0x60, "CS", modality) + element(0x18, 0x50, "DS", "2") +
         element(0x20, 0xd, "UI", "1.2.3") + element(0x20, 0xe, "UI", series_uid) +
         element(0x20, 0x13, "IS", std::to_string(number)) + element(0x20, 0x32, "DS", listed(position)) +
         element(0x20, 0x37, "DS", listed(orientation)) + element(0x28, 2, "US", u16(1)) +
         element(0x28, 4, "CS", "MONOCHROME2") + element(0x28, 0x10, "US", u16(static_cast<std::size_t>(rows))) +
         element(0x28, 0x11, "US", u16(static_cast<std::size_t>(columns))) + element(0x28, 0x30, "DS", "0.5\\0.25") +
         element(0x28, 0x100, "US", u16(16)) + element(0x28, 0x101, "US", u16(16)) +
         element(0x28, 0x102, "US", u16(15)) + element(0x28, 0x103, "US", u16(0)) +
         long_element(0x7fe0, 0x10, "OW", pixels);
}

}  // namespace anatomesh::testing
