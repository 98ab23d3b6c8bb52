#include "assess/conformity.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "assess/box_tree.h"
#include "assess/facet.h"
#include "assess/point_grid.h"
#include "base/parallel.h"
#include "base/sort_and_unify.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {
namespace {

/// Number of i in [0, n) for which the test holds.
template <class Test>
std::uint64_t count_where(std::size_t n, const Test& test) {
  return static_cast<std::uint64_t>(parallel_sum(n, 1024, [&](std::size_t begin, std::size_t end) {
    std::size_t count = 0;
    for (std::size_t i = begin; i < end; ++i) count += test(i);
    return static_cast<double>(count);
  }));
}

std::vector<VertexId> used_vertices(const VertexStars& stars) {
  std::vector<VertexId> used;
  for (VertexId v = 0; v + 1 < stars.first.size(); ++v) {
    if (!stars.of(v).empty()) used.push_back(v);
  }
  return used;
}

std::uint64_t count_unused(const TissueMesh& mesh, const std::vector<VertexId>& used) {
  std::vector<char> in_use(mesh.points_mm.size(), 0);
  for (const VertexId v : used) in_use[v] = 1;
  for (const auto& tet : mesh.dropped) {
    for (const VertexId v : tet) in_use[v] = 1;
  }
  return in_use.size() - static_cast<std::uint64_t>(std::accumulate(in_use.begin(), in_use.end(), std::size_t{0}));
}

std::uint64_t count_duplicates(const TissueMesh& mesh, const std::vector<VertexId>& used, const PointGrid& grid) {
  const double radius = 1e-9 * grid.extent();
  return count_where(used.size(), [&](std::size_t i) {
    bool seen_before = false;
    grid.within(mesh.points_mm[used[i]], radius, [&](VertexId v) { seen_before |= v < used[i]; });
    return seen_before;
  });
}

Facet facet_of(const Triangle& t, std::span<const Vec3> points) { return {points[t[0]], points[t[1]], points[t[2]]}; }

/// Marks vertices at the middle of an edge that is not theirs.
void mark_on_edges(const TissueMesh& mesh, const VertexStars& stars, const PointGrid& grid, double tolerance_mm,
                   std::vector<char>& hanging) {
  parallel_blocks(mesh.points_mm.size(), 1024, [&](std::size_t begin, std::size_t end) {
    std::vector<VertexId> ends;
    for (std::size_t v = begin; v < end; ++v) {
      edges_above(static_cast<VertexId>(v), mesh, stars, ends);
      for (const VertexId w : ends) {
        const Vec3 a = mesh.points_mm[v], b = mesh.points_mm[w];
        if (norm(b - a) <= 4 * tolerance_mm) continue;
        grid.within(0.5 * (a + b), tolerance_mm,
                    [&](VertexId u) { std::atomic_ref<char>(hanging[u]).store(1, std::memory_order_relaxed); });
      }
    }
  });
}

/// Marks vertices of the outer surface that lie on one of its triangles but are none of its corners. Where the faces of
/// two tetrahedra lie on each other without being one, both are outer.
void mark_on_outer_faces(const TissueMesh& mesh, std::span<const Triangle> outer, double tolerance_mm,
                         std::vector<char>& hanging) {
  std::vector<Box> boxes(outer.size(), Box::empty());
  parallel_for(outer.size(), [&](std::size_t i) {
    for (const VertexId v : outer[i]) boxes[i].include(mesh.points_mm[v]);
  });
  const BoxTree tree(boxes);
  std::vector<VertexId> candidates;
  for (const Triangle& t : outer) candidates.insert(candidates.end(), t.begin(), t.end());
  sort_and_unify(candidates);

  const double reach = tolerance_mm * tolerance_mm;
  parallel_for(candidates.size(), [&](std::size_t i) {
    const VertexId v = candidates[i];
    const Vec3 p = mesh.points_mm[v];
    tree.nearer_than(p, reach, [&](std::size_t n, double&) {
      const Triangle& t = outer[tree.order()[n]];
      for (const VertexId corner : t) {  // a duplicate of a corner is counted as such, not here
        if (norm_squared(mesh.points_mm[corner] - p) < reach) return;
      }
      if (facet_of(t, mesh.points_mm).distance_squared(p, reach) < reach) hanging[v] = 1;
    });
  });
}

/// Whether p lies inside the tetrahedron, away from its faces.
bool strictly_inside(Vec3 p, const std::array<VertexId, 4>& tet, std::span<const Vec3> points) {
  const auto six_volumes = [](Vec3 a, Vec3 b, Vec3 c, Vec3 d) { return dot(cross(b - a, c - a), d - a); };
  std::array<Vec3, 4> corners;
  for (std::size_t k = 0; k < 4; ++k) corners[k] = points[tet[k]];
  const double whole = six_volumes(corners[0], corners[1], corners[2], corners[3]);
  if (whole == 0) return false;
  for (std::size_t k = 0; k < 4; ++k) {
    auto part = corners;
    part[k] = p;
    if (!(six_volumes(part[0], part[1], part[2], part[3]) / whole > 1e-6)) return false;
  }
  return true;
}

std::uint64_t count_faces_before_material(const TissueMesh& mesh, std::span<const Triangle> outer) {
  std::vector<Box> boxes(mesh.tets.size(), Box::empty());
  parallel_for(mesh.tets.size(), [&](std::size_t i) {
    for (const VertexId v : mesh.tets[i]) boxes[i].include(mesh.points_mm[v]);
  });
  const BoxTree tree(boxes);
  return count_where(outer.size(), [&](std::size_t i) {
    const Facet f = facet_of(outer[i], mesh.points_mm);
    const double size = std::sqrt(norm(cross(f.b - f.a, f.c - f.a)));
    const Vec3 before = 1.0 / 3 * (f.a + f.b + f.c) + 1e-3 * size * f.normal;
    bool material = false;
    constexpr double kInsideTheBox = std::numeric_limits<double>::min();
    tree.nearer_than(before, kInsideTheBox, [&](std::size_t n, double&) {
      material = material || strictly_inside(before, mesh.tets[tree.order()[n]], mesh.points_mm);
    });
    return material;
  });
}

std::uint64_t count_folded_tets(const TissueMesh& mesh, const Neighbours& neighbours) {
  return count_where(mesh.tets.size(), [&](std::size_t t) {
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const TetId other = neighbours.across[t][corner];
      if (other >= kCrowded || other < t) continue;
      const auto at = [&](std::size_t n) { return mesh.points_mm[mesh.tets[t][(corner + n) % 4]]; };
      const Vec3 normal = cross(at(2) - at(1), at(3) - at(1));
      const auto& behind = mesh.tets[other];
      const auto apex = std::ranges::find_if(behind, [&](VertexId v) {
        return v != mesh.tets[t][(corner + 1) % 4] && v != mesh.tets[t][(corner + 2) % 4] &&
               v != mesh.tets[t][(corner + 3) % 4];
      });
      if (dot(normal, at(0) - at(1)) * dot(normal, mesh.points_mm[*apex] - at(1)) > 0) return true;
    }
    return false;
  });
}

}  // namespace

Conformity check_conformity(const TissueMesh& mesh, const VertexStars& stars, const Neighbours& neighbours,
                            const Skeleton& whole, std::span<const Triangle> outer) {
  Conformity result;
  result.negative_orientation = mesh.negative_orientation;
  result.background_tets = mesh.dropped.size();
  result.faces = neighbours.faces;
  result.outer_faces = neighbours.outer_faces;
  result.faces_in_more_than_two_tets = neighbours.crowded_faces;
  result.folded_tets = count_folded_tets(mesh, neighbours);

  const std::vector<VertexId> used = used_vertices(stars);
  result.unused_vertices = count_unused(mesh, used);
  if (used.empty()) return result;
  const PointGrid grid(mesh.points_mm, used);
  result.duplicate_vertices = count_duplicates(mesh, used, grid);

  const double tolerance_mm = 1e-6 * whole.edge_length_mm / static_cast<double>(whole.edges);
  std::vector<char> hanging(mesh.points_mm.size(), 0);
  mark_on_edges(mesh, stars, grid, tolerance_mm, hanging);
  mark_on_outer_faces(mesh, outer, tolerance_mm, hanging);
  result.hanging_vertices = count_where(hanging.size(), [&](std::size_t v) { return hanging[v] != 0; });
  result.outer_faces_with_material_outside = count_faces_before_material(mesh, outer);
  return result;
}

}  // namespace anatomesh::assess_detail
