// Distances between a tissue's surface in the mesh and the boundary of its voxels.
#pragma once

#include <span>
#include <stop_token>
#include <vector>

#include "anatomesh/assess.h"
#include "assess/surface.h"
#include "assess/voxel_block.h"

namespace anatomesh::assess_detail {

/// Both ways. points_vox: the mesh's points in voxel indices of the image that the block was cut out of. The mesh is
/// sampled at the centroids of equal parts of its triangles with edges of at most half the smallest spacing, and its
/// vertices; each side of a voxel at the middles of at least 2 x 2 parts. surface and block must not be empty. Cost: a
/// few hundred nanoseconds a sample.
SurfaceDistance surface_distance(std::span<const Triangle> surface, const std::vector<Vec3>& points_vox,
                                 const VoxelBlock& block, Vec3 spacing_mm, const std::stop_token& cancel);

}  // namespace anatomesh::assess_detail
