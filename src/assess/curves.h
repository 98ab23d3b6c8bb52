// Shape of quadratic tetrahedra.
#pragma once

#include "anatomesh/assess.h"

namespace anatomesh::assess_detail {

/// Of a mesh whose tetrahedra all have edge nodes. Tetrahedra of label 0 are left out.
/// Throws InvalidInput (edge nodes that are not as many as tetrahedra, or that are no points).
Curves measure_curves(const TetMesh& mesh);

}  // namespace anatomesh::assess_detail
