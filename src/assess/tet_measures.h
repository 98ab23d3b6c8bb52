// Shape of single tetrahedra.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "assess/tissue_mesh.h"

namespace anatomesh::assess_detail {

struct TetMeasures {
  double min_dihedral_deg = 0;  ///< 0 to 180
  double max_dihedral_deg = 0;  ///< 0 to 180
  double volume_mm3 = 0;        ///< signed
  double mean_ratio = 0;        ///< 12 (3 V)^(2/3) / sum of squared edges; 0 for V <= 0
  double scaled_jacobian = 0;   ///< Verdict's: sqrt(2) J / max(J, products of the three edges at a vertex)
  double min_edge_mm = 0;
  double max_edge_mm = 0;
  std::array<std::uint8_t, 6> dihedral_bin = {};  ///< of each angle, bins of 5 degrees

  /// Volumes nearer to zero than this are zero within rounding.
  double zero_volume_mm3() const { return 1e-12 * max_edge_mm * max_edge_mm * max_edge_mm; }
  bool inverted() const { return volume_mm3 < -zero_volume_mm3(); }
  bool degenerate() const { return !inverted() && volume_mm3 <= zero_volume_mm3(); }
};

/// Corners of the face opposite each corner of a positively oriented tetrahedron; the normal points outward.
inline constexpr std::array<std::array<std::size_t, 3>, 4> kFaceOfTet = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// The two corners of each edge, then the other two.
inline constexpr std::array<std::array<std::size_t, 4>, 6> kEdgeOfTet = {
    {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};

TetMeasures measure_tet(const std::array<Vec3, 4>& corners_mm);

/// One for each tetrahedron of the mesh.
std::vector<TetMeasures> measure_tets(const TissueMesh& mesh);

}  // namespace anatomesh::assess_detail
