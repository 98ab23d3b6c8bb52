// The surface of a tissue: the faces of its tetrahedra toward another tissue or the outside.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "assess/adjacency.h"
#include "assess/tet_measures.h"

namespace anatomesh::assess_detail {

using Triangle = std::array<VertexId, 3>;

/// Triangles with the normal outward, in the order of `tets`, which must be all of the tissue's.
std::vector<Triangle> surface_of(std::span<const TetId> tets, Scope scope, const TissueMesh& mesh,
                                 const std::vector<TetMeasures>& measures, const Neighbours& neighbours);

}  // namespace anatomesh::assess_detail
