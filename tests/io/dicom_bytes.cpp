#include "io/dicom_bytes.h"

namespace anatomesh::testing {

std::string dicom_u16(std::size_t number) {
  return {static_cast<char>(number & 255), static_cast<char>(number >> 8 & 255)};
}

std::string dicom_u32(std::size_t number) { return dicom_u16(number & 65535) + dicom_u16(number >> 16); }

std::string dicom_element(std::uint16_t group, std::uint16_t tag, const std::string& type, std::string value) {
  if (value.size() % 2 != 0) value += type == "UI" ? '\0' : ' ';
  return dicom_u16(group) + dicom_u16(tag) + type + dicom_u16(value.size()) + value;
}

std::string long_dicom_element(std::uint16_t group, std::uint16_t tag, const std::string& type,
                               const std::string& value) {
  return dicom_u16(group) + dicom_u16(tag) + type + dicom_u16(0) + dicom_u32(value.size()) + value;
}

}  // namespace anatomesh::testing
