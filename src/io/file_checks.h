// What ITK's readers would let pass, or print about: looked at in the file before they see it.
#pragma once

#include <cstddef>
#include <filesystem>

namespace anatomesh {

/// Looks at a NRRD, MetaImage or MINC file: ITK 5.2 takes a truncated MetaImage for a whole one, broken
/// compressed voxels for good ones, and turns spacings that are negative or no numbers into something else.
/// Other files pass. Throws IoError (truncated, damaged), InvalidInput (spacing).
void check_before_itk(const std::filesystem::path& path);

/// Whether the library that ITK reads this file with prints on its own.
bool is_read_by_printing_library(const std::filesystem::path& path);

/// Whether that library crashes on some damaged files: libminc by HDF5, and GDCM, to which come folders and all files
/// that no other knows.
bool is_read_by_crashing_library(const std::filesystem::path& path);

/// Throws IoError where the uncompressed pixel data of a DICOM file, of at least so many bytes, are cut off:
/// GDCM takes what is missing for zeros.
void check_dicom_pixels(const std::filesystem::path& path, std::size_t least_bytes);

}  // namespace anatomesh
