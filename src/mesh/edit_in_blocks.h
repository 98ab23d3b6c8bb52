// Local changes of a mesh by several threads at once.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "mesh/mesh_editor.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// How a mesh is cut into blocks: in two along the longest side of its box, again and again, until none has more
/// than `most` tetrahedra. Two ways of cutting with different shares have few seams in common.
struct BlockCuts {
  std::size_t most = 0;  ///< > 0
  double share = 0.5;    ///< of the tetrahedra, that go to the first part; > 0, < 1
};

/// Cuts a mesh into blocks, calls `edit` on each, all at once, and puts them together again. A block's editor knows the
/// tetrahedra of the block only: vertices on its seams look like those on the far side of the cushion (is_outer()).
/// They must stay where they are, and `edit` must not add vertices. `vertices`: the numbers in the mesh of those in the
/// editor.
///
/// is_due: by vertex of the mesh, whether there is work left at it. Those, and no others, have changed_at() 1 in the
/// editor, all others 0. Afterwards those on seams are due where they were before or where tetrahedra at them have
/// changed, and no others are.
///
/// Returns the mesh with the numbers of its vertices as before, dead ones included. The result does not depend on the
/// number of threads.
TissueMesh edit_in_blocks(const TissueMesh& mesh, const BlockCuts& cuts, std::vector<char>& is_due,
                          const std::function<void(MeshEditor& editor, std::span<const VertexId> vertices)>& edit);

}  // namespace anatomesh
