// After CGAL 5.5's examples mesh_3D_image.cpp and mesh_3D_weighted_image.cpp.
#include "benchmarks/cgal_mesh_3/cgal_mesher.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_3/generate_label_weights.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/version.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <chrono>
#include <unordered_map>
#include <utility>

#include "anatomesh/errors.h"
#include "benchmarks/cgal_mesh_3/cgal_image.h"

namespace anatomesh::peers {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
namespace named = CGAL::parameters;

/// CGAL's types for one thread (CGAL::Sequential_tag) or several (CGAL::Parallel_tag).
template <class Concurrency>
struct Types {
  using Triangulation = typename CGAL::Mesh_triangulation_3<Domain, CGAL::Default, Concurrency>::type;
  using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
  using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
};

/// Both images must outlive the domain, which refers to them.
Domain make_domain(const CgalImage& crop, const CGAL::Image_3& weights) {
  constexpr double kErrorBound = 1e-6;  // of the bisection for surface points, as in CGAL's examples
  return Domain::create_labeled_image_mesh_domain(crop.image, named::relative_error_bound = kErrorBound,
                                                  named::weights = weights);
}

template <class Concurrency>
auto make_complex(const Domain& domain, const CgalOptions& options) {
  using Complex = typename Types<Concurrency>::Complex;
  const typename Types<Concurrency>::Criteria criteria(
      named::facet_angle = options.facet_angle_deg, named::facet_size = options.facet_size_mm,
      named::facet_distance = options.facet_distance_mm, named::cell_radius_edge_ratio = options.cell_radius_edge_ratio,
      named::cell_size = options.cell_size_mm);
  if (!options.optimise) return CGAL::make_mesh_3<Complex>(domain, criteria, named::no_perturb(), named::no_exude());
  return CGAL::make_mesh_3<Complex>(domain, criteria, named::perturb(named::sliver_bound = options.sliver_bound_deg),
                                    named::exude(named::sliver_bound = options.sliver_bound_deg));
}

template <class Point>
Vec3 to_physical(const LabelImage& image, const CgalImage& crop, const Point& point) {
  const Vec3 s = image.spacing_mm;
  const double local[3] = {point.x() + static_cast<double>(crop.corner_vox[0]) * s.x,
                           point.y() + static_cast<double>(crop.corner_vox[1]) * s.y,
                           point.z() + static_cast<double>(crop.corner_vox[2]) * s.z};
  const Mat3& d = image.direction;
  const auto along = [&](std::size_t row) {
    return d[row][0] * local[0] + d[row][1] * local[1] + d[row][2] * local[2];
  };
  return {image.origin_mm.x + along(0), image.origin_mm.y + along(1), image.origin_mm.z + along(2)};
}

bool is_mirrored(const Mat3& d) {
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
             d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]) <
         0;
}

/// CGAL's tetrahedra are positively oriented in the image's frame.
template <class Complex>
TetMesh to_mesh(const LabelImage& image, const CgalImage& crop, const Complex& complex) {
  TetMesh mesh;
  std::unordered_map<const void*, VertexId> numbers;
  const bool mirrored = is_mirrored(image.direction);
  for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
    std::array<VertexId, 4> tet{};
    for (int corner = 0; corner < 4; ++corner) {
      const auto vertex = cell->vertex(corner);
      const auto [place, is_new] = numbers.emplace(&*vertex, static_cast<VertexId>(mesh.points_mm.size()));
      if (is_new) mesh.points_mm.push_back(to_physical(image, crop, vertex->point()));
      tet[static_cast<std::size_t>(corner)] = place->second;
    }
    if (mirrored) std::swap(tet[2], tet[3]);
    mesh.tets.push_back(tet);
    mesh.labels.push_back(crop.labels.at(static_cast<std::size_t>(complex.subdomain_index(cell))));
  }
  return mesh;
}

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

const char* cgal_version() { return CGAL_STRINGIZE(CGAL_VERSION); }

TetMesh mesh_with_cgal(const LabelImage& image, const CgalOptions& options, CgalTimes& times) {
  const CgalImage crop = make_cgal_image(image);
  auto begin = std::chrono::steady_clock::now();
  CGAL::Image_3 weights;
  if (options.weights_sigma_mm > 0)
    weights = CGAL::Mesh_3::generate_label_weights(crop.image, static_cast<float>(options.weights_sigma_mm));
  times.weights_s = seconds_since(begin);
  begin = std::chrono::steady_clock::now();
  const Domain domain = make_domain(crop, weights);
  const auto mesh_by = [&]<class Concurrency>(Concurrency) {
    const auto complex = make_complex<Concurrency>(domain, options);
    times.mesh_s = seconds_since(begin);
    return to_mesh(image, crop, complex);
  };
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  static_cast<std::size_t>(std::max(options.threads, 1)));
  TetMesh mesh = options.threads > 1 ? mesh_by(CGAL::Parallel_tag()) : mesh_by(CGAL::Sequential_tag());
  if (mesh.tets.empty()) throw MeshingFailed("CGAL gave no tetrahedron");
  return mesh;
}

}  // namespace anatomesh::peers
