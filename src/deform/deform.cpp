#include "deform/deform.h"

#include <algorithm>

#include "boundary/edge_points.h"
#include "deform/angle_guard.h"
#include "deform/improve.h"
#include "deform/register_mesh.h"
#include "deform/settle.h"
#include "deform/split_bridges.h"

namespace anatomesh {
namespace {

constexpr int kSettleSweeps = 4;

std::vector<Material> materials_of(const TissueImage& image, const DeformOptions& options) {
  std::vector<Material> materials(image.labels.size(), options.default_material);
  for (std::size_t t = 1; t < materials.size(); ++t) {
    const auto own = options.material.find(image.labels[t]);
    if (own != options.material.end()) materials[t] = own->second;
  }
  return materials;
}

// None for a lattice that is kept as it is.
std::vector<EdgePoint> find_targets(const TissueImage& image, const DeformOptions& options, const Stage& stage) {
  if (options.iterations == 0) return {};
  return thin_edge_points(find_edge_points(image, stage.cancel_token()), options.non_connectivity);
}

}  // namespace

ShapeBounds bounds_of(const DeformOptions& options) {
  return ShapeBounds::from_degrees(options.min_dihedral_deg, options.max_dihedral_deg, options.min_mean_ratio);
}

Deformer::Deformer(const TissueImage& image, const DeformOptions& options, const Stage& stage)
    : image_(image),
      options_(options),
      bounds_(bounds_of(options)),
      materials_(materials_of(image, options)),
      field_(image),
      targets_(find_targets(image, options, stage)) {}

void Deformer::approach(TissueMesh& mesh, const Stage& stage) const {
  if (options_.iterations == 0) return;
  split_bridges(mesh, bounds_, stage);
  const MeshTopology topology = make_topology(mesh);
  const AngleGuard guard(mesh, topology, bounds_);
  register_mesh(mesh, topology, guard, field_, targets_, materials_, options_.iterations,
                stage.part("register", 0.1, 0.7));
  VolumeShifts shifts(image_);
  settle(mesh, topology, guard, field_, kSettleSweeps, shifts, stage.part("settle", 0.7, 1.0));
}

void Deformer::finish(TissueMesh& mesh, const ImproveOptions& improvement, const Stage& stage) const {
  if (options_.iterations == 0) return;
  VolumeShifts shifts(image_);
  improve(mesh, field_, bounds_, improvement, shifts, stage);
}

}  // namespace anatomesh
