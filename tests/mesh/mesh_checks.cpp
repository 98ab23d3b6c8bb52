#include "mesh/mesh_checks.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>
#include <tuple>
#include <utility>

#include "base/vec.h"

namespace anatomesh::testing {
namespace {

constexpr std::array<std::array<std::size_t, 4>, 6> kEdgesAndOpposite = {
    {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};

Vec3 without_part_along(Vec3 v, Vec3 unit) { return v - dot(v, unit) * unit; }

// Angle between the faces (i, j, k) and (i, j, l), seen along the edge i j.
double dihedral_deg(const Corners& c, std::array<std::size_t, 4> ijkl) {
  const Vec3 edge = c[ijkl[1]] - c[ijkl[0]];
  const Vec3 unit = (1 / norm(edge)) * edge;
  const Vec3 k = without_part_along(c[ijkl[2]] - c[ijkl[0]], unit);
  const Vec3 l = without_part_along(c[ijkl[3]] - c[ijkl[0]], unit);
  return std::atan2(norm(cross(k, l)), dot(k, l)) * 180 / std::numbers::pi;
}

double signed_volume(const Corners& c) { return dot(c[1] - c[0], cross(c[2] - c[0], c[3] - c[0])) / 6; }

Face sorted_face(const Tet& tet, std::size_t opposite) {
  Face face{};
  for (std::size_t v = 0, n = 0; v < 4; ++v) {
    if (v != opposite) face[n++] = tet[v];
  }
  std::sort(face.begin(), face.end());
  return face;
}

auto as_tuple(Vec3 p) { return std::tuple(p.x, p.y, p.z); }

bool less(Vec3 a, Vec3 b) { return as_tuple(a) < as_tuple(b); }

struct Box {
  Vec3 low, high;

  explicit Box(const std::array<Vec3, 3>& points) : low(points[0]), high(points[0]) {
    for (const Vec3 p : points) {
      for (std::size_t a = 0; a < 3; ++a) {
        low[a] = std::min(low[a], p[a]);
        high[a] = std::max(high[a], p[a]);
      }
    }
  }
  bool contains(Vec3 p, double margin) const {
    for (std::size_t a = 0; a < 3; ++a) {
      if (!(p[a] >= low[a] - margin && p[a] <= high[a] + margin)) return false;
    }
    return true;
  }
};

// Whether p lies in the triangle, to a millionth of its size.
bool in_triangle(const std::array<Vec3, 3>& t, Vec3 p, double size) {
  const Vec3 normal = cross(t[1] - t[0], t[2] - t[0]);
  const double area2 = norm(normal);
  if (std::abs(dot(p - t[0], normal)) > 1e-6 * size * area2) return false;
  for (std::size_t n = 0; n < 3; ++n) {
    const Vec3 a = t[n], b = t[(n + 1) % 3];
    if (dot(cross(b - a, p - a), normal) < -1e-6 * area2 * area2) return false;
  }
  return true;
}

}  // namespace

Shape shape_of(const Corners& corners) {
  Shape shape;
  shape.volume = signed_volume(corners);
  double squared_edges = 0;
  for (const auto& ijkl : kEdgesAndOpposite) {
    squared_edges += norm_squared(corners[ijkl[1]] - corners[ijkl[0]]);
    const double angle = dihedral_deg(corners, ijkl);
    shape.min_dihedral_deg = std::min(shape.min_dihedral_deg, angle);
    shape.max_dihedral_deg = std::max(shape.max_dihedral_deg, angle);
  }
  shape.mean_ratio = 12 * std::pow(3 * std::abs(shape.volume), 2.0 / 3) / squared_edges;
  return shape;
}

Corners corners_of(std::span<const Vec3> points, const Tet& tet) {
  return {points[tet[0]], points[tet[1]], points[tet[2]], points[tet[3]]};
}

Shape worst_shape(std::span<const Vec3> points, std::span<const Tet> tets) {
  Shape worst;
  worst.mean_ratio = 1;
  for (const Tet& tet : tets) {
    const Shape shape = shape_of(corners_of(points, tet));
    worst.volume += shape.volume;
    worst.min_dihedral_deg = std::min(worst.min_dihedral_deg, shape.min_dihedral_deg);
    worst.max_dihedral_deg = std::max(worst.max_dihedral_deg, shape.max_dihedral_deg);
    worst.mean_ratio = std::min(worst.mean_ratio, shape.mean_ratio);
  }
  return worst;
}

double smallest_volume(std::span<const Vec3> points, std::span<const Tet> tets) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const Tet& tet : tets) smallest = std::min(smallest, signed_volume(corners_of(points, tet)));
  return smallest;
}

std::array<double, 4> barycentric_of(const Corners& corners, Vec3 p) {
  const double whole = signed_volume(corners);
  std::array<double, 4> share{};
  for (std::size_t n = 0; n < 4; ++n) {
    Corners part = corners;
    part[n] = p;
    share[n] = signed_volume(part) / whole;
  }
  return share;
}

double depth_inside(const Corners& corners, Vec3 p) {
  const auto share = barycentric_of(corners, p);
  return *std::min_element(share.begin(), share.end());
}

std::vector<SharedFace> all_faces(std::span<const Tet> tets) {
  std::vector<std::pair<Face, std::size_t>> sides;
  sides.reserve(4 * tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::size_t n = 0; n < 4; ++n) sides.emplace_back(sorted_face(tets[t], n), t);
  }
  std::sort(sides.begin(), sides.end());
  std::vector<SharedFace> faces;
  for (const auto& [face, tet] : sides) {
    if (faces.empty() || faces.back().vertices != face) faces.push_back({face, {}});
    faces.back().tets.push_back(tet);
  }
  return faces;
}

std::vector<Face> outer_faces(std::span<const Tet> tets) {
  std::vector<Face> outer;
  for (const SharedFace& face : all_faces(tets)) {
    if (face.tets.size() == 1) outer.push_back(face.vertices);
  }
  return outer;
}

std::size_t crowded_faces(std::span<const Vec3> points, std::span<const Tet> tets) {
  const auto side = [&](const SharedFace& face, std::size_t n) {
    const Vec3 a = points[face.vertices[0]], b = points[face.vertices[1]], c = points[face.vertices[2]];
    Vec3 centre;
    for (const VertexId v : tets[face.tets[n]]) centre += 0.25 * points[v];
    return dot(cross(b - a, c - a), centre - a) > 0;
  };
  std::size_t crowded = 0;
  for (const SharedFace& face : all_faces(tets)) {
    if (face.tets.size() > 2 || (face.tets.size() == 2 && side(face, 0) == side(face, 1))) ++crowded;
  }
  return crowded;
}

double area_of(std::span<const Vec3> points, std::span<const Face> faces) {
  double area = 0;
  for (const auto& [a, b, c] : faces) area += 0.5 * norm(cross(points[b] - points[a], points[c] - points[a]));
  return area;
}

std::size_t vertices_in_edge_middles(std::span<const Vec3> points, std::span<const Tet> tets) {
  std::vector<Vec3> places(points.begin(), points.end());
  std::sort(places.begin(), places.end(), less);
  std::set<std::tuple<double, double, double>> hanging;
  for (const Tet& tet : tets) {
    for (const auto& [i, j, k, l] : kEdgesAndOpposite) {
      const Vec3 middle = 0.5 * (points[tet[i]] + points[tet[j]]);
      if (std::binary_search(places.begin(), places.end(), middle, less)) hanging.insert(as_tuple(middle));
    }
  }
  return hanging.size();
}

std::size_t vertices_inside_outer_faces(std::span<const Vec3> points, std::span<const Tet> tets) {
  const std::vector<Face> outer = outer_faces(tets);
  std::set<VertexId> vertices;
  for (const Face& face : outer) vertices.insert(face.begin(), face.end());
  std::size_t found = 0;
  for (const Face& face : outer) {
    const std::array<Vec3, 3> triangle = {points[face[0]], points[face[1]], points[face[2]]};
    const double size = norm(triangle[1] - triangle[0]);
    const Box box(triangle);
    for (const VertexId v : vertices) {
      if (!box.contains(points[v], 1e-6 * size)) continue;
      const bool own = std::find(face.begin(), face.end(), v) != face.end();
      if (!own && in_triangle(triangle, points[v], size)) ++found;
    }
  }
  return found;
}

std::size_t duplicate_vertices(std::span<const Vec3> points) {
  std::vector<Vec3> places(points.begin(), points.end());
  std::sort(places.begin(), places.end(), less);
  const auto end = std::unique(places.begin(), places.end());
  return static_cast<std::size_t>(places.end() - end);
}

std::size_t unused_vertices(std::size_t vertex_count, std::span<const Tet> tets) {
  std::vector<bool> used(vertex_count, false);
  for (const Tet& tet : tets) {
    for (const VertexId v : tet) used[v] = true;
  }
  return static_cast<std::size_t>(std::count(used.begin(), used.end(), false));
}

}  // namespace anatomesh::testing
