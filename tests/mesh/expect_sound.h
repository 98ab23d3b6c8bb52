// What every mesh, of whatever stage, must be.
#pragma once

#include <gtest/gtest.h>

#include "mesh/mesh_checks.h"

namespace anatomesh::testing {

/// Faces fit, no vertex is lost, hangs or is there twice, and all volumes are positive.
inline void expect_sound(std::span<const Vec3> points, std::span<const Tet> tets) {
  EXPECT_EQ(crowded_faces(points, tets), 0u);
  EXPECT_EQ(vertices_in_edge_middles(points, tets), 0u);
  EXPECT_EQ(duplicate_vertices(points), 0u);
  EXPECT_EQ(unused_vertices(points.size(), tets), 0u);
  EXPECT_GT(smallest_volume(points, tets), 0);
}

inline void expect_within(const Shape& worst, double min_dihedral_deg, double max_dihedral_deg, double min_mean_ratio) {
  EXPECT_GE(worst.min_dihedral_deg, min_dihedral_deg);
  EXPECT_LE(worst.max_dihedral_deg, max_dihedral_deg);
  EXPECT_GE(worst.mean_ratio, min_mean_ratio);
}

}  // namespace anatomesh::testing
