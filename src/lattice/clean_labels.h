// Removal of label noise from the lattice: single tetrahedra that stick out of, or are cut off from, their tissue.
#pragma once

#include <functional>

#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// Gives a tetrahedron the tissue that lies behind three of its faces, or behind most of them when none leads to its
/// own tissue: the two cases in which no surface can become worse. A few rounds in order of number. Tissues of few
/// tetrahedra are left alone. may_change(t): whether tetrahedron t may lose its label; called in parallel.
void clean_labels(TissueMesh& mesh, const std::function<bool(TetId)>& may_change);

}  // namespace anatomesh
