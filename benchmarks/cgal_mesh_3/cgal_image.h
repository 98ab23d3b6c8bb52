// A label image as CGAL takes it.
#pragma once

#include <CGAL/Image_3.h>

#include <array>
#include <vector>

#include "anatomesh/label_image.h"

namespace anatomesh::peers {

/// The labelled part of an image, with labels counted from 1 in increasing order so that they fit CGAL's word types.
struct CgalImage {
  CGAL::Image_3 image;                         ///< words of 8 bits, or of 16 from 256 labels on; origin at 0
  bool wide = false;                           ///< words of 16 bits
  std::vector<Label> labels;                   ///< CGAL's label -> that of the LabelImage; 0 -> 0
  std::array<std::ptrdiff_t, 3> corner_vox{};  ///< index of the crop's voxel (0, 0, 0); may be negative
};

/// Throws InvalidInput when nothing is labelled or more than 65,535 labels are used.
CgalImage make_cgal_image(const LabelImage& image);

}  // namespace anatomesh::peers
