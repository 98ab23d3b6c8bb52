#include "deform/settle.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "base/parallel.h"
#include "base/vec.h"
#include "deform/boundary_step.h"
#include "deform/interface_faces.h"

namespace anatomesh {
namespace {

double env(const char* name, double other) {
  const char* s = std::getenv(name);
  return s ? std::atof(s) : other;
}

// Solves the symmetric positive definite system A x = b.
Vec3 solve_symmetric(const Mat3& a, Vec3 b) {
  const Vec3 c0 = {a[0][0], a[1][0], a[2][0]}, c1 = {a[0][1], a[1][1], a[2][1]}, c2 = {a[0][2], a[1][2], a[2][2]};
  const double det = dot(c0, cross(c1, c2));
  return (1 / det) * Vec3{dot(b, cross(c1, c2)), dot(c0, cross(b, c2)), dot(c0, cross(c1, b))};
}

// A ball of this many voxels just keeps its place in the smoothed field.
constexpr std::uint64_t kTinyVoxels = 8;

bool touches_tiny_tissue(std::span<const TissueId> tissues, const TissueImage& image) {
  return std::any_of(tissues.begin(), tissues.end(), [&](TissueId t) { return image.counts[t] < kTinyVoxels; });
}

// The boundary near a face, to first order: the plane of x with normal . x == level.
struct TangentPlane {
  Vec3 normal;  // of length 1 from the lower to the higher tissue; zero: none
  double level = 0;
  double weight = 0;
};

TangentPlane tangent_plane(const TissueMesh& mesh, const InterfaceFace& face, const SurfaceField& field, double voxel) {
  const Vec3 a = mesh.points_mm[face.vertices[0]], b = mesh.points_mm[face.vertices[1]],
             c = mesh.points_mm[face.vertices[2]];
  const Vec3 centre = (1.0 / 3) * (a + b + c), area = cross(b - a, c - a);
  const std::array<TissueId, 2> pair = {face.low, face.high};
  std::array<double, 2> share;
  std::array<Vec3, 2> gradient;
  field.evaluate(centre, pair, share, gradient);
  const Vec3 up = gradient[1] - gradient[0];
  const double steep = norm(up);
  if (steep * voxel < 1e-3 || dot(up, area) <= 0) return {};
  const Vec3 normal = (1 / steep) * up;
  const double off = std::clamp((share[0] - share[1]) / steep, -0.5 * voxel, 0.5 * voxel);
  return {normal, dot(normal, centre) + off, 0.5 * norm(area)};
}

Vec3 laplacian(const TissueMesh& mesh, const MeshTopology& topology, VertexId v) {
  const auto neighbours = topology.interface_neighbours[v];
  if (neighbours.size() < 2) return {};
  Vec3 mean;
  for (const VertexId w : neighbours) mean += mesh.points_mm[w];
  return (1.0 / static_cast<double>(neighbours.size())) * mean - mesh.points_mm[v];
}

}  // namespace

void settle(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const SurfaceField& field,
            int sweeps, const Stage& stage) {
  const InterfaceFaces interfaces = find_interface_faces(mesh, topology);
  const Vec3 spacing = field.image().spacing_mm;
  const double voxel = std::max({spacing.x, spacing.y, spacing.z});
  std::vector<TangentPlane> planes(interfaces.faces.size());
  std::vector<Vec3> laplacians(mesh.points_mm.size());
  const double kOwn = env("KOWN", 0.25), kFair = env("KFAIR", 0.3), kTang = env("KTANG", 0.5);
  sweeps = static_cast<int>(env("KSWEEPS", sweeps));
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    parallel_for(planes.size(),
                 [&](std::size_t f) { planes[f] = tangent_plane(mesh, interfaces.faces[f], field, voxel); });
    parallel_for(laplacians.size(), [&](std::size_t v) {
      laplacians[v] = laplacian(mesh, topology, static_cast<VertexId>(v));
    });
    std::array<std::atomic<int>, 8> count{};
    for_each_vertex_by_colour(topology, stage, [&](VertexId v) {
      const auto tissues = topology.tissues_of_vertex[v];
      if (!topology.on_interface(v) || touches_tiny_tissue(tissues, field.image())) return;
      const Vec3 from = mesh.points_mm[v];
      const bool junction = tissues.size() > 2;
      // Data: planes of the faces around.
      Mat3 normal = {};
      Vec3 rhs;
      double total = 0;
      for (const std::uint32_t f : interfaces.of_vertex[v]) total += planes[f].weight;
      if (total == 0) return;
      const auto add = [&](Vec3 n, double off, double weight) {
        for (std::size_t r = 0; r < 3; ++r) {
          for (std::size_t c = 0; c < 3; ++c) normal[r][c] += weight * n[r] * n[c];
        }
        rhs += weight * off * n;
      };
      Vec3 mean_normal;
      for (const std::uint32_t f : interfaces.of_vertex[v]) {
        const TangentPlane& plane = planes[f];
        if (plane.weight == 0) continue;
        const auto& vertices = interfaces.faces[f].vertices;
        const Vec3 centre =
            (1.0 / 3) * (mesh.points_mm[vertices[0]] + mesh.points_mm[vertices[1]] + mesh.points_mm[vertices[2]]);
        add(plane.normal, plane.level - dot(plane.normal, centre), (1 - kOwn) * plane.weight / total);
        mean_normal += plane.weight * plane.normal;
      }
      const Vec3 own = boundary_step(field, from, tissues);
      if (norm_squared(own) > 0) {
        const double length = norm(own);
        if (length > 1e-9 * voxel) add((1 / length) * own, length, kOwn);
      } else if (junction) {
      }
      // Where smoothing wants it.
      const Vec3 lap = laplacian(mesh, topology, v);
      Vec3 mean_lap;
      int same = 0;
      for (const VertexId w : topology.interface_neighbours[v]) {
        if (topology.tissues_of_vertex[w].size() != tissues.size()) continue;
        mean_lap += laplacians[w];
        ++same;
      }
      Vec3 fair;
      if (same > 0) fair = lap - (1.0 / same) * mean_lap;
      Vec3 wish = kTang * lap;
      if (junction) {
        // along the line: only the tangential part of the relaxation, fairing across
        const auto nb = topology.interface_neighbours[v];
        if (nb.size() == 2) {
          const Vec3 t = mesh.points_mm[nb[1]] - mesh.points_mm[nb[0]];
          const double tt = norm_squared(t);
          if (tt > 0) wish = (dot(t, wish) / tt) * t + (fair - (dot(t, fair) / tt) * t);
        } else {
          wish = {};
        }
      } else {
        const double nn = norm_squared(mean_normal);
        if (nn > 0) wish = wish + (dot(mean_normal, fair - wish) / nn) * mean_normal;
      }
      rhs += kFair * wish;
      for (std::size_t r = 0; r < 3; ++r) normal[r][r] += kFair;
      Vec3 step = solve_symmetric(normal, rhs);
      const double voxels =
          std::max({std::abs(step.x) / spacing.x, std::abs(step.y) / spacing.y, std::abs(step.z) / spacing.z});
      if (voxels > 1) step = (1 / voxels) * step;
      const double gone = guard.advance(v, from + step, 2);
      if (gone == 1) ++count[junction ? 1 : 0];
      else if (gone > 0) ++count[junction ? 3 : 2];
      else ++count[junction ? 5 : 4];
    });
    if (std::getenv("SVERB") && sweep == sweeps - 1)
      printf("sweep %d: full %d part %d none %d; junction %d %d %d\n", sweep, count[0].load(), count[2].load(),
             count[4].load(), count[1].load(), count[3].load(), count[5].load());
    relax_interior(mesh, topology, guard, stage);
    stage.at(static_cast<double>(sweep + 1) / sweeps);
  }
}

}  // namespace anatomesh
