// Whether the tetrahedra fit together: duplicate, unused and hanging vertices, faces too many, overlap.
#pragma once

#include <span>

#include "anatomesh/assess.h"
#include "assess/adjacency.h"
#include "assess/surface.h"

namespace anatomesh::assess_detail {

/// Everything but voxel_centres_in_several_tets. outer: the surface of the whole.
/// Cost: about a microsecond a tetrahedron.
Conformity check_conformity(const TissueMesh& mesh, const VertexStars& stars, const Neighbours& neighbours,
                            const Skeleton& whole, std::span<const Triangle> outer);

}  // namespace anatomesh::assess_detail
