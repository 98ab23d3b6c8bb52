#include "assess/surface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anatomesh/errors.h"
#include "assess/box_tree.h"
#include "assess/facet.h"
#include "assess/statistics.h"
#include "assess/voxel_surface.h"
#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh::assess_detail {
namespace {

constexpr std::size_t kGrain = 256;  // triangles or sides in a row that share what the query before found

/// Distances of nearby points asked for one after the other: the distance of one bounds that of the next.
template <class DistanceSquared>
class NearbyQueries {
 public:
  explicit NearbyQueries(const DistanceSquared& distance_squared) : distance_squared_(distance_squared) {}

  float operator()(Vec3 p) {
    const double reach = last_distance_ + norm(p - last_);
    // A little above the bound, so that a distance equal to it is still found.
    const double found = distance_squared_(p, reach * reach * (1 + 1e-12) + std::numeric_limits<double>::min());
    last_ = p;
    last_distance_ = std::sqrt(found);
    return static_cast<float>(last_distance_);
  }

 private:
  const DistanceSquared& distance_squared_;
  Vec3 last_;
  double last_distance_ = 1e150;
};

/// Triangles in the order of a tree of their boxes.
class FacetTree {
 public:
  explicit FacetTree(const std::vector<Facet>& facets) : tree_(boxes_of(facets)) {
    facets_.reserve(facets.size());
    for (const std::uint32_t i : tree_.order()) facets_.push_back(facets[i]);
  }

  /// Squared distance of p to the nearest triangle if it is below the reach, else the reach.
  double distance_squared(Vec3 p, double reach_squared) const {
    tree_.nearer_than(p, reach_squared, [&](std::size_t n, double& reach) {
      const double d = facets_[n].distance_squared(p, reach);
      if (d < reach) reach_squared = reach = d;
    });
    return reach_squared;
  }

 private:
  static std::vector<Box> boxes_of(const std::vector<Facet>& facets) {
    std::vector<Box> boxes(facets.size(), Box::empty());
    parallel_for(facets.size(), [&](std::size_t i) {
      for (const Vec3 p : {facets[i].a, facets[i].b, facets[i].c}) boxes[i].include(p);
    });
    return boxes;
  }

  BoxTree tree_;
  std::vector<Facet> facets_;
};

struct Samples {
  std::vector<Weighted> distances;  // weight: area in mm2 that the sample stands for; 0 for vertices
  double area_mm2 = 0;
};

OneWayDistance sum_up(Samples& samples) {
  auto& all = samples.distances;
  OneWayDistance d;
  const double moment = parallel_sum(all.size(), 65536, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += double{all[i].value} * double{all[i].weight};
    return sum;
  });
  const double weight = parallel_sum(all.size(), 65536, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += double{all[i].weight};
    return sum;
  });
  d.mean_mm = weight > 0 ? moment / weight : 0;
  if (!(weight > 0)) {
    for (const Weighted& s : all) d.mean_mm += double{s.value} / static_cast<double>(all.size());
  }
  d.max_mm = 0;
  for (const Weighted& s : all) d.max_mm = std::max(d.max_mm, double{s.value});
  d.p95_mm = weighted_quantile(all, 0.95);
  return d;
}

/// A surface in voxel indices times the spacing.
struct MeshSurface {
  std::vector<Facet> facets;
  std::vector<Vec3> vertices;  ///< each once
};

MeshSurface place_surface(std::span<const Triangle> surface, const std::vector<Vec3>& points_vox, Vec3 spacing) {
  const auto place = [&](VertexId v) {
    const Vec3 p = points_vox[v];
    return Vec3{p.x * spacing.x, p.y * spacing.y, p.z * spacing.z};
  };
  MeshSurface placed;
  placed.facets.reserve(surface.size());
  std::vector<bool> seen(points_vox.size(), false);
  for (const Triangle& t : surface) {
    placed.facets.emplace_back(place(t[0]), place(t[1]), place(t[2]));
    for (const VertexId v : t) {
      if (!seen[v]) placed.vertices.push_back(place(v));
      seen[v] = true;
    }
  }
  return placed;
}

double area_of(const Facet& f) { return norm(cross(f.b - f.a, f.c - f.a)) / 2; }

/// Into how many parts each edge of a triangle is cut for samples `step` apart.
std::size_t parts_of(const Facet& f, double step_mm) {
  constexpr double kMostParts = 40;
  const double longest =
      std::sqrt(std::max({norm_squared(f.b - f.a), norm_squared(f.c - f.b), norm_squared(f.a - f.c)}));
  return static_cast<std::size_t>(std::clamp(std::ceil(longest / step_mm), 1.0, kMostParts));
}

/// Calls sample(p) at the centroids of the n * n parts of a triangle, neighbours one after the other.
template <class Sample>
void sample_facet(const Facet& f, std::size_t n, const Sample& sample) {
  const auto parts = static_cast<double>(n);
  const auto at = [&](double u, double v) { return f.a + u / parts * (f.b - f.a) + v / parts * (f.c - f.a); };
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; i + j < n; ++j) {
      const auto u = static_cast<double>(i), v = static_cast<double>(j);
      sample(at(u + 1.0 / 3, v + 1.0 / 3));
      if (i + j + 1 < n) sample(at(u + 2.0 / 3, v + 2.0 / 3));
    }
  }
}

/// Distances of the vertices and of the samples of the mesh's surface.
Samples mesh_samples(const MeshSurface& surface, double step_mm, const VoxelDistance& boundary,
                     const std::stop_token& cancel) {
  const auto& [facets, vertices] = surface;
  const auto distance = [&](Vec3 p, double reach) { return boundary.distance_squared(p, reach); };
  std::vector<std::size_t> first(facets.size() + 1, 0);
  for (std::size_t i = 0; i < facets.size(); ++i) {
    const std::size_t n = parts_of(facets[i], step_mm);
    first[i + 1] = first[i] + n * n;
  }
  Samples samples;
  samples.distances.resize(first.back() + vertices.size());
  parallel_blocks(facets.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    if (cancel.stop_requested()) throw Cancelled();
    NearbyQueries nearby(distance);
    for (std::size_t i = begin; i < end; ++i) {
      const Facet& f = facets[i];
      const std::size_t n = parts_of(f, step_mm);
      Weighted* out = &samples.distances[first[i]];
      const auto weight = static_cast<float>(area_of(f) / static_cast<double>(n * n));
      sample_facet(f, n, [&](Vec3 p) { *out++ = {nearby(p), weight}; });
    }
  });
  parallel_blocks(vertices.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    NearbyQueries nearby(distance);
    for (std::size_t i = begin; i < end; ++i) samples.distances[first.back() + i] = {nearby(vertices[i]), 0};
  });
  for (const Facet& f : facets) samples.area_mm2 += area_of(f);
  return samples;
}

/// How the sides across one axis are sampled.
struct SideGrid {
  std::size_t across, u, v;  // axes
  std::size_t u_parts, v_parts;
  double area_mm2;  // of a side

  SideGrid(std::size_t axis, Vec3 spacing) : across(axis), u(axis == 0 ? 1 : 0), v(axis == 2 ? 1 : 2) {
    const double smallest = std::min({spacing.x, spacing.y, spacing.z});
    u_parts = parts(spacing[u] / smallest);
    v_parts = parts(spacing[v] / smallest);
    area_mm2 = spacing[u] * spacing[v];
  }
  std::size_t samples() const { return u_parts * v_parts; }

 private:
  /// At least two; what is a whole number but for rounding counts as that.
  static std::size_t parts(double ratio) {
    return std::max<std::size_t>(2, static_cast<std::size_t>(std::ceil(ratio - 1e-6)));
  }
};

/// Calls sample(p) at the middles of the parts of a side.
template <class Sample>
void sample_side(const VoxelSide& side, const SideGrid& grid, Vec3 spacing, const Sample& sample) {
  const auto place = [&](std::size_t axis, double offset) {
    return (static_cast<double>(side.voxel[axis]) + offset) * spacing[axis];
  };
  const auto middle = [](std::size_t i, std::size_t parts) {
    return (static_cast<double>(i) + 0.5) / static_cast<double>(parts) - 0.5;
  };
  Vec3 p;
  p[grid.across] = place(grid.across, 0.5);
  for (std::size_t i = 0; i < grid.u_parts; ++i) {
    p[grid.u] = place(grid.u, middle(i, grid.u_parts));
    for (std::size_t j = 0; j < grid.v_parts; ++j) {
      p[grid.v] = place(grid.v, middle(j, grid.v_parts));
      sample(p);
    }
  }
}

/// Distances of the samples of the voxels' boundary.
Samples image_samples(const std::vector<VoxelSide>& sides, Vec3 spacing, const FacetTree& surface,
                      const std::stop_token& cancel) {
  const auto distance = [&](Vec3 p, double reach) { return surface.distance_squared(p, reach); };
  const std::array<SideGrid, 3> grids = {SideGrid(0, spacing), SideGrid(1, spacing), SideGrid(2, spacing)};
  const auto grid_of = [&](const VoxelSide& s) -> const SideGrid& { return grids[static_cast<std::size_t>(s.axis)]; };
  std::vector<std::size_t> first_of_block;
  std::size_t count = 0;
  Samples samples;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i % kGrain == 0) first_of_block.push_back(count);
    count += grid_of(sides[i]).samples();
    samples.area_mm2 += grid_of(sides[i]).area_mm2;
  }
  samples.distances.resize(count);
  parallel_blocks(sides.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    if (cancel.stop_requested()) throw Cancelled();
    NearbyQueries nearby(distance);
    Weighted* out = &samples.distances[first_of_block[begin / kGrain]];
    for (std::size_t i = begin; i < end; ++i) {
      const SideGrid& grid = grid_of(sides[i]);
      const auto weight = static_cast<float>(grid.area_mm2 / static_cast<double>(grid.samples()));
      sample_side(sides[i], grid, spacing, [&](Vec3 p) { *out++ = {nearby(p), weight}; });
    }
  });
  return samples;
}

}  // namespace

SurfaceDistance surface_distance(std::span<const Triangle> surface, const std::vector<Vec3>& points_vox,
                                 const VoxelBlock& block, Vec3 spacing_mm, const std::stop_token& cancel) {
  const MeshSurface placed = place_surface(surface, points_vox, spacing_mm);
  SurfaceDistance d;
  double mesh_area = 0, image_area = 0;
  {
    const double step_mm = 0.5 * std::min({spacing_mm.x, spacing_mm.y, spacing_mm.z});
    Samples samples = mesh_samples(placed, step_mm, VoxelDistance(block, spacing_mm), cancel);
    mesh_area = samples.area_mm2;
    d.mesh_to_image = sum_up(samples);
  }
  {
    Samples samples = image_samples(boundary_of(block), spacing_mm, FacetTree(placed.facets), cancel);
    image_area = samples.area_mm2;
    d.image_to_mesh = sum_up(samples);
  }
  d.mean_mm = (d.mesh_to_image.mean_mm * mesh_area + d.image_to_mesh.mean_mm * image_area) / (mesh_area + image_area);
  d.p95_mm = std::max(d.mesh_to_image.p95_mm, d.image_to_mesh.p95_mm);
  d.max_mm = std::max(d.mesh_to_image.max_mm, d.image_to_mesh.max_mm);
  return d;
}

}  // namespace anatomesh::assess_detail
