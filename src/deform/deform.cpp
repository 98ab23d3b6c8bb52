#include "deform/deform.h"

#include "boundary/edge_points.h"
#include "boundary/label_field.h"
#include <cstdio>
#include <cstdlib>
#include <chrono>
#include "deform/angle_guard.h"
#include "deform/coarsen.h"
#include "deform/register_mesh.h"
#include "deform/settle.h"
#include "deform/split_bridges.h"

namespace anatomesh {
namespace {

constexpr int kSettleSweeps = 8;

std::vector<Material> materials_of(const TissueImage& image, const DeformOptions& options) {
  std::vector<Material> materials(image.labels.size(), options.default_material);
  for (std::size_t t = 1; t < materials.size(); ++t) {
    const auto own = options.material.find(image.labels[t]);
    if (own != options.material.end()) materials[t] = own->second;
  }
  return materials;
}

}  // namespace

void deform(TissueMesh& mesh, const TissueImage& image, const DeformOptions& options, const Stage& stage) {
  const ShapeBounds bounds =
      ShapeBounds::from_degrees(options.min_dihedral_deg, options.max_dihedral_deg, options.min_mean_ratio);
  split_bridges(mesh, bounds, stage);
  const MeshTopology topology = make_topology(mesh);
  const AngleGuard guard(mesh, topology, bounds);
  const std::vector<EdgePoint> targets =
      thin_edge_points(find_edge_points(image, stage.cancel_token()), options.non_connectivity);
  const LabelField field(image);
  register_mesh(mesh, topology, guard, field, targets, materials_of(image, options), options.iterations,
                stage.part("register", 0.1, 0.7));
  settle(mesh, topology, guard, field, kSettleSweeps, stage.part("settle", 0.7, 1.0));
  const auto env = [](const char* n, double d) { const char* s = std::getenv(n); return s ? std::atof(s) : d; };
  MeshEditor editor(mesh);
  CoarsenLimits limits;
  limits.bounds = ShapeBounds::from_degrees(options.min_dihedral_deg + env("DLO", 0), options.max_dihedral_deg - env("DHI", 0), options.min_mean_ratio);
  limits.max_turn_cos = std::cos(env("TURN", 25) * 3.14159265 / 180);
  const int rounds = static_cast<int>(env("ROUNDS", 8));
  for (int r = 0; r < rounds; ++r) {
    limits.surface_tolerance_mm = env("TOL", 0) * std::min(1.0, (r + 1) / env("RAMP", 1));
    auto t0 = std::chrono::steady_clock::now();
    std::size_t before = editor.tissue_tets();
    std::size_t n = coarsen_round(editor, field, limits, stage);
    std::fprintf(stderr, "round %d gone %zu tets %zu -> %zu  %.2f s\n", r, n, before, editor.tissue_tets(),
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count());
  }
  mesh = editor.result();
}

}  // namespace anatomesh
