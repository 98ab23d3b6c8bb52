// Registration of the mesh onto the edge points of the image, regularised by a linear-elastic model, after Liu,
// Foteinos, Chernikov and Chrisochoides, "Mesh deformation-based multi-tissue mesh generation for brain images",
// Engineering with Computers 28, 2012. Departures: matching is to the nearest edge point of the same pair of tissues
// (unless it lies on the far side of a thin sheet), and every step goes through the angle guard; what a vertex could
// not go is asked for again in the next iteration.
#pragma once

#include <span>
#include <vector>

#include "anatomesh/options.h"
#include "base/stage.h"
#include "boundary/edge_points.h"
#include "boundary/surface_field.h"
#include "deform/angle_guard.h"

namespace anatomesh {

/// Moves the mesh `iterations` times by the minimiser of U^T K U + (H U - D)^T S (H U - D) as far as the guard lets it.
/// materials: one a tissue, [0] unused. The tissues' tetrahedra and vertices come before the cushion's.
void register_mesh(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const SurfaceField& field,
                   std::span<const EdgePoint> targets, std::span<const Material> materials, int iterations,
                   const Stage& stage);

}  // namespace anatomesh
