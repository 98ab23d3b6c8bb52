#include "deform/deform.h"

#include "boundary/edge_points.h"
#include "boundary/surface_field.h"
#include "deform/angle_guard.h"
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
  const SurfaceField field(image);
  register_mesh(mesh, topology, guard, field, targets, materials_of(image, options), options.iterations,
                stage.part("register", 0.1, 0.7));
  settle(mesh, topology, guard, field, kSettleSweeps, stage.part("settle", 0.7, 1.0));
}

}  // namespace anatomesh
