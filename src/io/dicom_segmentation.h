// DICOM segmentation objects: one file with the masks of all segments, frame by frame.
#pragma once

#include <filesystem>

#include "anatomesh/io.h"

namespace anatomesh {

/// Whether a file says at its start that it is such an object.
bool is_dicom_segmentation(const std::filesystem::path& path);

/// As read_label_image(), for a file that is_dicom_segmentation(). Labels are the numbers of the segments.
ImageFile read_dicom_segmentation(const std::filesystem::path& path);

}  // namespace anatomesh
