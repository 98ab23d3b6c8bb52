// Canny edge points of a label image, a set for each pair of tissues that meet.
#pragma once

#include <array>
#include <compare>
#include <span>
#include <stop_token>
#include <vector>

#include "anatomesh/options.h"
#include "image/tissue_image.h"

namespace anatomesh {

/// Two different tissues, of which either may be the background.
struct TissuePair {
  TissueId low = 0, high = 0;  ///< low < high
  auto operator<=>(const TissuePair&) const = default;
};

/// A point on the boundary of two tissues, with sub-voxel accuracy.
struct EdgePoint {
  Vec3 position_mm;  ///< in the image's frame (TissueImage::centre_mm)
  TissuePair pair;
  std::array<int, 3> voxel = {0, 0, 0};  ///< (i, j, k) of the crop's voxel that holds it
  bool operator==(const EdgePoint&) const = default;
};

/// The edge points of every two tissues that meet, ordered by voxel (i fastest), then pair; at most one a voxel
/// and pair. Every two tissues that share a voxel face have at least one. The same for any number of threads.
/// Throws Cancelled when `cancel` is requested.
/// Cost: one pass over the voxels (about 1 ns each) and 0.5 us for each voxel face between two tissues.
std::vector<EdgePoint> find_edge_points(const TissueImage& image, std::stop_token cancel = {});

/// A maximal subset in which no two points of the same pair are in voxels that touch at a vertex (26 neighbours),
/// edge (18) or face (6), or in the same voxel; NonConnectivity::none keeps all. The points are taken in the order
/// of their voxels (i fastest), each unless one taken before touches it; the result is in the order given.
/// Cost: linear where the points are ordered by voxel as find_edge_points() returns them, else a sort more.
std::vector<EdgePoint> thin_edge_points(std::span<const EdgePoint> points, NonConnectivity pattern);

}  // namespace anatomesh
