#include "deform/deform.h"

#include "boundary/edge_points.h"
#include "boundary/label_field.h"
#include <cstdio>
#include <cstdlib>
#include <chrono>
#include "deform/angle_guard.h"
#include "deform/coarsen.h"
#include "deform/improve_shapes.h"
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
  const auto coarsen = [&](int rounds, double tol, int ramp, double margin) {
    MeshEditor editor(mesh);
    CoarsenLimits limits;
    limits.bounds = ShapeBounds::from_degrees(options.min_dihedral_deg + margin, options.max_dihedral_deg - margin, options.min_mean_ratio);
    limits.max_turn_cos = std::cos(env("TURN", 25) * 3.14159265 / 180);
    for (int r = 0; r < rounds; ++r) {
      limits.surface_tolerance_mm = tol * std::min(1.0, (r + 1.0) / ramp);
      auto t0 = std::chrono::steady_clock::now();
      std::size_t before = editor.tissue_tets();
      std::size_t n = coarsen_round(editor, field, limits, stage);
      std::fprintf(stderr, "round %d gone %zu tets %zu -> %zu  %.2f s\n", r, n, before, editor.tissue_tets(),
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count());
    }
    mesh = editor.result();
  };
  const auto resettle = [&](int sweeps) {
    const MeshTopology t2 = make_topology(mesh);
    const AngleGuard g2(mesh, t2, bounds);
    settle(mesh, t2, g2, field, sweeps, stage);
  };
  const auto improve = [&](int rounds, double enough) {
    MeshEditor editor(mesh);
    for (int r = 0; r < rounds; ++r) {
      auto t0 = std::chrono::steady_clock::now();
      std::size_t before = editor.tissue_tets();
      std::size_t n = improve_shapes(editor, bounds, enough, stage);
      std::fprintf(stderr, "improve %d changes %zu tets %zu -> %zu  %.2f s\n", r, n, before, editor.tissue_tets(),
                 std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count());
    }
    mesh = editor.result();
  };
  const char* plan = std::getenv("PLAN");
  for (const char* p = plan ? plan : ""; *p; ++p) {
    if (*p == 'i') coarsen(static_cast<int>(env("ROUNDS", 8)), 0, 1, env("DLO", 0));
    if (*p == 's') coarsen(static_cast<int>(env("SROUNDS", 8)), env("TOL", 0.3), static_cast<int>(env("RAMP", 6)), env("DLS", 0));
    if (*p == 'f') improve(static_cast<int>(env("FROUNDS", 3)), env("ENOUGH", 0.05));
    if (*p == '1') resettle(static_cast<int>(env("SWEEPS", 8)));
  }
}

}  // namespace anatomesh
