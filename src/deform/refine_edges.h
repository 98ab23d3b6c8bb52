// Finer elements where a mesh is going to have new boundaries.
#pragma once

#include <functional>

#include "base/stage.h"
#include "mesh/mesh_editor.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

/// Splits edges that are longer than about four thirds of what size_at(their middle) asks (mm), the longest for their
/// size first, where the halves lie inside the bounds; in between, what became bad is improved, so that more can be
/// split. Edges between two outer vertices stay. The background counts as any tissue. Ends when there are max_tets
/// tetrahedra. Returns the number of splits. Deterministic. Throws Cancelled.
std::size_t refine_edges(MeshEditor& mesh, const ShapeBounds& bounds, const std::function<double(Vec3)>& size_at,
                         std::size_t max_tets, const Stage& stage);

/// Splits the longest edge of each of these tetrahedra that can be split inside the bounds, of the living ones among
/// them. Returns the number of splits.
std::size_t split_tets(MeshEditor& mesh, const ShapeBounds& bounds, const std::vector<TetId>& tets);

/// Splits the edges at a vertex, the longest first, where the halves lie inside the bounds. Returns the number of
/// splits.
std::size_t split_around(MeshEditor& mesh, const ShapeBounds& bounds, VertexId v);

/// Splits inner edges of tetrahedra that have all their vertices on interfaces, the longest first, where the halves
/// are well shaped, as split_bridges() does for a whole mesh. Returns the number of splits.
std::size_t split_bridges(MeshEditor& mesh, const ShapeBounds& bounds, const Stage& stage);

}  // namespace anatomesh
