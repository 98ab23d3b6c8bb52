// The mesh as the stages between lattice and result work on it.
#pragma once

#include <array>
#include <vector>

#include "anatomesh/types.h"
#include "image/tissue_image.h"

namespace anatomesh {

/// A conforming tetrahedral mesh in the image's axis-aligned frame (see TissueImage), positively
/// oriented. Tetrahedra of tissue 0 are the cushion: the background around the tissues' outer surface, kept
/// positive while vertices move so that no two sheets of the surface can pass through each other, and dropped
/// at the end.
struct TissueMesh {
  std::vector<Vec3> points_mm;
  std::vector<std::array<VertexId, 4>> tets;
  std::vector<TissueId> tissues;  ///< one a tetrahedron
};

/// Tetrahedra without the cushion's.
std::size_t tissue_tets(const TissueMesh& mesh);

/// Volume of the tetrahedra of each tissue, the cushion's included. tissues: how many there are, with the background.
std::vector<double> tissue_volumes_mm3(const TissueMesh& mesh, std::size_t tissues);

/// The same mesh with the tissues' tetrahedra before the cushion's, and their vertices before those of the cushion
/// alone; otherwise in the same order. The stages rely on it. Vertices of no tetrahedron are dropped.
TissueMesh with_cushion_last(const TissueMesh& mesh);

/// The same with tetrahedra that lie near each other near each other in memory, too: along a Z-order curve. What walks
/// over the mesh finds most of what it needs in the cache.
TissueMesh in_spatial_order(const TissueMesh& mesh);

}  // namespace anatomesh
