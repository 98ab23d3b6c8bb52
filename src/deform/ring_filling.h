// New tetrahedra in place of those around an edge.
#pragma once

#include <array>
#include <vector>

#include "mesh/edge_ring.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

/// Without its edge ab, the ring of an edge is filled by triangulating the polygon of its link and joining each
/// triangle to a and to b. This finds the triangulation whose worst tetrahedron has most slack, by dynamic programming
/// (G. T. Klincsek, "Minimal triangulations of polygonal domains", 1980; for tetrahedra: J. R. Shewchuk, "Two discrete
/// optimization algorithms for the topological improvement of tetrahedral meshes", 2002).
class RingFilling {
 public:
  explicit RingFilling(const MeshEditor& mesh) : mesh_(mesh) {}

  /// Worst slack of the best filling of the polygon link[first] .. link[last], with link[ring.size] for link[0]; -2
  /// where there is none with more than `enough`. At most kMax^3 / 3 tetrahedra are looked at.
  double fill(const EdgeRing& ring, std::size_t first, std::size_t last, const ShapeBounds& bounds, double enough);

  /// Appends the tetrahedra of the filling last found, of (a part of) that polygon.
  void append(std::size_t first, std::size_t last, std::vector<std::array<VertexId, 4>>& tets) const;

 private:
  static constexpr std::size_t kCorners = EdgeRing::kMax + 1;
  template <class T>
  using Table = std::array<std::array<T, kCorners>, kCorners>;

  const MeshEditor& mesh_;
  VertexId a_ = 0, b_ = 0;
  std::array<VertexId, kCorners> link_ = {};
  // Of the polygon link[i] .. link[j]: the best it can be filled, and the corner of the triangle at ij that does so.
  Table<double> best_ = {};
  Table<std::size_t> apex_ = {};
};

}  // namespace anatomesh
