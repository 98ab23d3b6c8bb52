// Quality of a set of tetrahedra.
#pragma once

#include <span>

#include "anatomesh/assess.h"
#include "assess/adjacency.h"
#include "assess/tet_measures.h"

namespace anatomesh::assess_detail {

/// Quality of the given tetrahedra, all those of one tissue or of all. Gradation looks at the faces among them.
Quality quality_of(std::span<const TetId> tets, Scope scope, const TissueMesh& mesh,
                   const std::vector<TetMeasures>& measures, const Neighbours& neighbours, const Skeleton& skeleton);

}  // namespace anatomesh::assess_detail
