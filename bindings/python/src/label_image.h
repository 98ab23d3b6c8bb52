// Label images out of NumPy's arrays.
#pragma once

#include <pybind11/numpy.h>

#include <map>
#include <string>
#include <vector>

#include "anatomesh/label_image.h"

namespace anatomesh::python {

/// Copies the voxels, in whatever order they lie in memory. `voxels` is indexed [i, j, k] and of this machine's byte
/// order. Throws InvalidInput (other than three axes, a type that holds no labels, a value that is no label).
LabelImage label_image_of(const pybind11::array& voxels, const std::array<double, 3>& spacing_mm,
                          const std::array<double, 3>& origin_mm, const Mat3& direction,
                          const std::map<Label, std::string>& names, const std::map<Label, Colour>& colours);

/// Turns all other labels into background.
void keep_labels(LabelImage& image, const std::vector<Label>& kept);

/// Throws InvalidInput where a name goes over several lines.
LabelTable label_table_of(const std::map<Label, std::string>& names, const std::map<Label, Colour>& colours);
std::map<Label, std::string> names_in(const LabelTable& table);
std::map<Label, Colour> colours_in(const LabelTable& table);

}  // namespace anatomesh::python
