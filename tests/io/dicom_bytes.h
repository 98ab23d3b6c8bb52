// Pieces of DICOM files, explicit little endian.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace anatomesh::testing {

std::string dicom_u16(std::size_t number);
std::string dicom_u32(std::size_t number);

/// One data element with a short length; text is padded to an even length.
std::string dicom_element(std::uint16_t group, std::uint16_t tag, const std::string& type, std::string value);

/// One data element with a long length.
std::string long_dicom_element(std::uint16_t group, std::uint16_t tag, const std::string& type,
                               const std::string& value);

}  // namespace anatomesh::testing
