// How long edges may be.
#pragma once

#include <vector>

#include "base/stage.h"
#include "image/size_field.h"
#include "mesh/mesh_editor.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

/// By vertex: the mean length of the interface edges at the interface vertex from which it is least, and `gradation`
/// times the way there along edges (mm). Infinity where no way leads. Cost: n log n.
std::vector<double> graded_sizes(const MeshEditor& mesh, double gradation);

/// Splits the edges of the tissues that are longer than the size wanted at their middles, the longest first, where
/// the halves lie inside the bounds. Returns the number of splits. Throws Cancelled.
std::size_t split_long_edges(MeshEditor& mesh, const ShapeBounds& bounds, const SizeField& sizes, const Stage& stage);

}  // namespace anatomesh
