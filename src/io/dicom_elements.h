// The data elements of DICOM files, read without GDCM, which aborts the process over many broken files.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <string_view>
#include <vector>

namespace anatomesh {

/// Group and element in one number: 0x00280010 is (0028,0010).
using DicomTag = std::uint32_t;

/// Data elements of a file, or of an item in one of its sequences, in the bytes of the file.
struct DicomElements {
  std::map<DicomTag, std::string_view> values;
  std::map<DicomTag, std::vector<DicomElements>> sequences;
};

/// Takes the elements out of the bytes of a file, which must outlive them. Throws IoError (truncated, damaged),
/// InvalidInput (compressed or big-endian).
DicomElements dicom_elements(const std::filesystem::path& path, std::string_view file);

}  // namespace anatomesh
