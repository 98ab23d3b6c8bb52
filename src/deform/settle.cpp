#include "deform/settle.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "base/parallel.h"
#include "base/vec.h"
#include "boundary/interface_level.h"
#include "deform/interface_faces.h"

namespace anatomesh {
namespace {

// What a vertex minimises is a sum of squared distances: of the faces around it from the boundary (at their centroids),
// of itself from the boundary, of the other ends of those faces from their tangent planes, of itself from where it
// would be evenly spaced. The weights of these parts:
constexpr double kOfFaces = 0.9;
constexpr double kOfVertex = 0.1;
constexpr double kOfNormals = 0.4;
constexpr double kOfSpacing = 0.04;
// Faces on the image's border lie there exactly.
constexpr double kOfBorder = 1e4;
// Share of the way to the mean of the neighbours in a sweep.
constexpr double kRelaxation = 0.5;

// A sum of squared distances to planes, as a function of a displacement.
struct Quadric {
  Mat3 matrix = {};
  Vec3 rhs;

  // weight * (normal . x - offset)^2
  void add(Vec3 normal, double offset, double weight) {
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) matrix[r][c] += weight * normal[r] * normal[c];
    }
    rhs += weight * offset * normal;
  }
  // weight * |x - wish|^2
  void add(Vec3 wish, double weight) {
    for (std::size_t r = 0; r < 3; ++r) matrix[r][r] += weight;
    rhs += weight * wish;
  }
  Vec3 minimiser() const {
    const Mat3& a = matrix;
    const Vec3 c0 = {a[0][0], a[1][0], a[2][0]}, c1 = {a[0][1], a[1][1], a[2][1]}, c2 = {a[0][2], a[1][2], a[2][2]};
    const double det = dot(c0, cross(c1, c2));
    return (1 / det) * Vec3{dot(rhs, cross(c1, c2)), dot(c0, cross(rhs, c2)), dot(c0, cross(c1, rhs))};
  }
};

// The boundary of two tissues near a point, to first order: the points x with normal . x == level.
struct Plane {
  Vec3 normal;  // of length 1, from the lower tissue to the higher
  double level = 0;
  double area = 0;  // of the face it belongs to, mm^2; 0: there is no plane
};

// A pair of tissues that meet at a vertex, and the sum of the area vectors of their faces there.
struct PairAtVertex {
  TissueId low, high;
  Vec3 area;
};

class Settling {
 public:
  Settling(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const SurfaceField& field,
           VolumeShifts& shifts)
      : mesh_(mesh),
        topology_(topology),
        guard_(guard),
        field_(field),
        interfaces_(find_interface_faces(mesh, topology, field.image())),
        planes_(interfaces_.faces.size()),
        shifts_(shifts) {
    const Vec3 s = field.image().spacing_mm;
    voxel_mm_ = std::max({s.x, s.y, s.z});
  }

  void keep_volumes() { shifts_.update(mesh_, interfaces_); }

  // Finds the boundary near each face as it lies now.
  void find_planes() {
    parallel_for(planes_.size(), [&](std::size_t f) { planes_[f] = plane_at_face(interfaces_.faces[f]); });
  }

  void settle_vertex(VertexId v) const {
    if (!topology_.on_interface(v) || touches_tiny_tissue(v)) return;
    Quadric quadric;
    if (!add_faces(v, quadric)) return;
    add_vertex(v, quadric);
    quadric.add(relaxation(v), kOfSpacing);
    const Vec3 from = mesh_.points_mm[v];
    Vec3 goal = from + limited(quadric.minimiser());
    const bool at_border = add_border(v, goal, quadric);
    double edge = 0;
    for (const VertexId w : topology_.neighbours[v]) edge += norm(mesh_.points_mm[w] - from);
    edge /= static_cast<double>(topology_.neighbours[v].size());
    guard_.advance_best(v, goal, quadric.matrix, edge / 5);
    if (at_border && mesh_.points_mm[v] != goal) guard_.advance(v, on_border(v, mesh_.points_mm[v]), 0);
  }

 private:
  bool touches_tiny_tissue(VertexId v) const {
    return std::ranges::any_of(topology_.tissues_of_vertex[v], [&](TissueId t) { return is_tiny(field_.image(), t); });
  }

  // None far from the boundary, and where the tissues lie the other way round: the far side of a thin sheet.
  std::optional<Plane> plane_at(Vec3 p, TissueId low, TissueId high, Vec3 area) const {
    const auto [difference, gradient] = field_.difference(p, low, high);
    const double steep = norm(gradient);
    if (steep * voxel_mm_ < 1e-3 || dot(gradient, area) <= 0) return {};
    const Vec3 normal = (1 / steep) * gradient;
    const double off = std::clamp(-difference / steep, -0.5 * voxel_mm_, 0.5 * voxel_mm_);
    return Plane{normal, dot(normal, p) + off, norm(area)};
  }

  Plane plane_at_face(const InterfaceFace& face) const {
    const Vec3 area = area_vector(mesh_, face);
    if (face.border) {
      Vec3 normal;
      normal[face.border->axis] = 1;
      return {normal, face.border->position_mm, norm(area)};
    }
    Plane plane = plane_at(centroid(mesh_, face), face.low, face.high, area).value_or(Plane{});
    plane.level += shifts_.between(face.low, face.high);
    return plane;
  }

  // The faces at v move with it, as their other vertices do the same. False if there is no boundary near any of them.
  bool add_faces(VertexId v, Quadric& quadric) const {
    double total = 0;
    for (const std::uint32_t f : interfaces_.of_vertex[v]) total += planes_[f].area;
    if (total == 0) return false;
    const Vec3 from = mesh_.points_mm[v];
    for (const std::uint32_t f : interfaces_.of_vertex[v]) {
      const Plane& plane = planes_[f];
      const double weight = plane.area / total;
      const Vec3 centre = centroid(mesh_, interfaces_.faces[f]), opposite = 1.5 * centre - 0.5 * from;
      quadric.add(plane.normal, plane.level - dot(plane.normal, centre), kOfFaces * weight);
      quadric.add(plane.normal, dot(plane.normal, opposite - from), kOfNormals * weight);
    }
    return true;
  }

  std::vector<PairAtVertex> pairs_at(VertexId v) const {
    std::vector<PairAtVertex> pairs;
    for (const std::uint32_t f : interfaces_.of_vertex[v]) {
      const InterfaceFace& face = interfaces_.faces[f];
      if (face.border) continue;
      const auto known =
          std::ranges::find_if(pairs, [&](const PairAtVertex& p) { return p.low == face.low && p.high == face.high; });
      if (known == pairs.end()) {
        pairs.push_back({face.low, face.high, area_vector(mesh_, face)});
      } else {
        known->area += area_vector(mesh_, face);
      }
    }
    return pairs;
  }

  void add_vertex(VertexId v, Quadric& quadric) const {
    const std::vector<PairAtVertex> pairs = pairs_at(v);
    for (const PairAtVertex& pair : pairs) {
      const Vec3 p = mesh_.points_mm[v];
      const auto plane = plane_at(p, pair.low, pair.high, pair.area);
      if (!plane) continue;
      quadric.add(plane->normal, plane->level - dot(plane->normal, p), kOfVertex / static_cast<double>(pairs.size()));
    }
  }

  // Towards the mean of the neighbours on the same surface or line; on a surface along it only, as the planes decide
  // about the way across. Where lines meet: nowhere.
  Vec3 relaxation(VertexId v) const {
    const auto neighbours = topology_.interface_neighbours[v];
    if (neighbours.size() < 2) return {};
    Vec3 mean;
    for (const VertexId w : neighbours) mean += mesh_.points_mm[w];
    Vec3 step = kRelaxation * ((1.0 / static_cast<double>(neighbours.size())) * mean - mesh_.points_mm[v]);
    if (topology_.tissues_of_vertex[v].size() > 2) return neighbours.size() == 2 ? step : Vec3{};
    Vec3 across;
    for (const std::uint32_t f : interfaces_.of_vertex[v]) across += planes_[f].area * planes_[f].normal;
    if (across == Vec3{}) return step;
    return step - (dot(across, step) / norm_squared(across)) * across;
  }

  // At most one voxel along any axis: the planes say nothing about what lies farther.
  Vec3 limited(Vec3 step) const {
    const Vec3 s = field_.image().spacing_mm;
    const double voxels = std::max({std::abs(step.x) / s.x, std::abs(step.y) / s.y, std::abs(step.z) / s.z});
    return voxels > 1 ? (1 / voxels) * step : step;
  }

  Vec3 on_border(VertexId v, Vec3 p) const {
    for (const std::uint32_t f : interfaces_.of_vertex[v]) {
      const auto& border = interfaces_.faces[f].border;
      if (border) p[border->axis] = border->position_mm;
    }
    return p;
  }

  bool add_border(VertexId v, Vec3& goal, Quadric& quadric) const {
    goal = on_border(v, goal);
    std::array<bool, 3> held = {};
    for (const std::uint32_t f : interfaces_.of_vertex[v]) {
      const auto& border = interfaces_.faces[f].border;
      if (border) held[border->axis] = true;
    }
    for (std::size_t axis = 0; axis < 3; ++axis) quadric.matrix[axis][axis] += held[axis] ? kOfBorder : 0;
    return held[0] || held[1] || held[2];
  }

  TissueMesh& mesh_;
  const MeshTopology& topology_;
  const AngleGuard& guard_;
  const SurfaceField& field_;
  InterfaceFaces interfaces_;
  std::vector<Plane> planes_;
  VolumeShifts& shifts_;
  double voxel_mm_;
};

}  // namespace

void settle(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const SurfaceField& field,
            int sweeps, VolumeShifts& shifts, const Stage& stage) {
  Settling settling(mesh, topology, guard, field, shifts);
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    if (sweep > 0) settling.keep_volumes();
    settling.find_planes();
    for_each_vertex_by_colour(topology, stage, [&](VertexId v) { settling.settle_vertex(v); });
    relax_interior(mesh, topology, guard, stage);
    stage.at(static_cast<double>(sweep + 1) / sweeps);
  }
}

}  // namespace anatomesh
