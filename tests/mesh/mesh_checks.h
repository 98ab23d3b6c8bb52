// What the tests of meshes measure, each by brute force and on its own: nothing here uses the library's formulas.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "anatomesh/types.h"

namespace anatomesh::testing {

using Tet = std::array<VertexId, 4>;
using Corners = std::array<Vec3, 4>;

/// Shape of one tetrahedron.
struct Shape {
  double volume = 0;  ///< signed
  double min_dihedral_deg = 180, max_dihedral_deg = 0;
  double mean_ratio = 0;  ///< of the volume's absolute value
};
Shape shape_of(const Corners& corners);

Corners corners_of(std::span<const Vec3> points, const Tet& tet);

/// Volume as the sum, and the worst of everything else.
Shape worst_shape(std::span<const Vec3> points, std::span<const Tet> tets);
double smallest_volume(std::span<const Vec3> points, std::span<const Tet> tets);

/// Barycentric coordinates of p.
std::array<double, 4> barycentric_of(const Corners& corners, Vec3 p);

/// Smallest of the barycentric coordinates: positive inside, 0 on a face.
double depth_inside(const Corners& corners, Vec3 p);

using Face = std::array<VertexId, 3>;

/// A face, and the tetrahedra that have it, as positions in the mesh.
struct SharedFace {
  Face vertices;  ///< ascending
  std::vector<std::size_t> tets;
};

/// Every face of the mesh once.
std::vector<SharedFace> all_faces(std::span<const Tet> tets);

/// The faces of one tetrahedron only.
std::vector<Face> outer_faces(std::span<const Tet> tets);

/// Number of faces of more than two tetrahedra, or of two on the same side of it.
std::size_t crowded_faces(std::span<const Vec3> points, std::span<const Tet> tets);

double area_of(std::span<const Vec3> points, std::span<const Face> faces);

/// Vertices in the middle of an edge of some tetrahedron (the hanging nodes that a refinement can leave).
std::size_t vertices_in_edge_middles(std::span<const Vec3> points, std::span<const Tet> tets);

/// Pairs of a vertex on the outer surface and an outer face or its edges that the vertex lies in without being a
/// vertex of it. Cost: quadratic, after a test of boxes.
std::size_t vertices_inside_outer_faces(std::span<const Vec3> points, std::span<const Tet> tets);

/// Vertices at the very place of another one, and vertices of no tetrahedron.
std::size_t duplicate_vertices(std::span<const Vec3> points);
std::size_t unused_vertices(std::size_t vertex_count, std::span<const Tet> tets);

}  // namespace anatomesh::testing
