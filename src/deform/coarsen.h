// Fewer elements: edge collapses that keep what the mesh says of the image.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "base/stage.h"
#include "boundary/surface_field.h"
#include "image/size_field.h"
#include "mesh/mesh_editor.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

/// What a collapse must keep.
struct CoarsenLimits {
  ShapeBounds bounds;                ///< of the new tetrahedra
  double surface_tolerance_mm = 0;   ///< how far interfaces may move, and lie from the boundary; 0: they stay
  double max_turn_cos = 0.9;         ///< cosine of the largest angle by which an interface face may turn
  const SizeField* sizes = nullptr;  ///< no edge longer than this is made; null: no limit
  std::vector<double> size_at;       ///< by vertex: the same around it, the mean of both ends; empty: no limit
  std::size_t target_tets = 0;       ///< stop when there are no more, without the cushion
  std::uint32_t since = 0;           ///< only vertices with changes since then, by the clock, and what changes now
};

/// Collapses each vertex, in the order of their numbers, onto the neighbour that keeps the worst of the new tetrahedra
/// best, where that is inside the limits. Vertices inside a tissue go onto any neighbour, those on an interface along
/// it, those on a line where three tissues meet along that line; where more meet they stay. A labelled link condition
/// keeps the topology: every tissue's region, its surface, the interfaces and junctions stay what they are up to where
/// they lie. Neighbours of a vertex that has gone are left alone until the next round; later rounds look at the
/// neighbourhoods that have changed only. Ends after `rounds`, or when a round finds (almost) nothing. Returns how many
/// vertices have gone. Deterministic. Cost: about 5 us a vertex. Throws Cancelled.
std::size_t coarsen(MeshEditor& mesh, const SurfaceField& field, const CoarsenLimits& limits, int rounds,
                    const Stage& stage);

}  // namespace anatomesh
