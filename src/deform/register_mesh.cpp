#include "deform/register_mesh.h"

#include <algorithm>

#include "base/parallel.h"
#include "base/vec.h"
#include "boundary/matching.h"
#include "deform/sides.h"
#include "fem/block_matrix.h"
#include "fem/solver.h"

namespace anatomesh {
namespace {

// Weight of a match against the mean stiffness of a vertex: high enough to bring most of the way in one iteration,
// low enough for the elastic model to smooth what single matches say.
constexpr double kMatchWeight = 1.0;
// A step that the guard cuts short anyway needs no more digits.
constexpr double kTolerance = 1e-2;
constexpr int kMaxSolverIterations = 200;
constexpr int kGuardSweeps = 2;
// When an iteration moves the interfaces by less than this on average, settling does the rest.
constexpr double kNear = 0.2;  // of a voxel

double mean_move(std::span<const Vec3> before, const TissueMesh& mesh, std::span<const VertexId> vertices) {
  double sum = 0;
  for (const VertexId v : vertices) sum += norm(mesh.points_mm[v] - before[v]);
  return vertices.empty() ? 0 : sum / static_cast<double>(vertices.size());
}

double mean_edge(const TissueMesh& mesh, const MeshTopology& topology, VertexId v) {
  double sum = 0;
  for (const VertexId w : topology.neighbours[v]) sum += norm(mesh.points_mm[w] - mesh.points_mm[v]);
  return sum / static_cast<double>(topology.neighbours[v].size());
}

std::vector<VertexId> interface_vertices(const MeshTopology& topology, std::size_t tissue_vertices) {
  std::vector<VertexId> vertices;
  for (VertexId v = 0; v < tissue_vertices; ++v) {
    if (topology.on_interface(v)) vertices.push_back(v);
  }
  return vertices;
}

// The part of the mesh without its cushion.
struct TissuePart {
  std::size_t vertices = 0;
  std::span<const std::array<VertexId, 4>> tets;
  std::span<const TissueId> tissues;

  TissuePart(const TissueMesh& mesh, const MeshTopology& topology) {
    const auto end = std::find(mesh.tissues.begin(), mesh.tissues.end(), TissueId{0}) - mesh.tissues.begin();
    tets = std::span(mesh.tets).first(static_cast<std::size_t>(end));
    tissues = std::span(mesh.tissues).first(static_cast<std::size_t>(end));
    while (vertices < mesh.points_mm.size() && !topology.outside(static_cast<VertexId>(vertices))) ++vertices;
  }
};

}  // namespace

void register_mesh(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const SurfaceField& field,
                   std::span<const EdgePoint> targets, std::span<const Material> materials, int iterations,
                   const Stage& stage) {
  const TissuePart part(mesh, topology);
  const EdgePointIndex index(targets);
  const std::vector<VertexId> vertices = interface_vertices(topology, part.vertices);
  std::vector<SourcePoint> sources;
  for (const VertexId v : vertices)
    sources.push_back({{}, topology.tissues_of_vertex[v], mean_edge(mesh, topology, v)});
  BlockMatrix stiffness{make_pattern(part.vertices, topology.neighbours), {}};
  std::vector<double> weight(part.vertices);
  std::vector<Vec3> wanted(part.vertices), u(part.vertices), goals(mesh.points_mm.size()), before;
  const Vec3 spacing = field.image().spacing_mm;
  const double near_mm = kNear * (spacing.x + spacing.y + spacing.z) / 3;
  for (int iteration = 0; iteration < iterations; ++iteration) {
    assemble_stiffness(stiffness, std::span(mesh.points_mm).first(part.vertices),
                       {part.tets, part.tissues, topology.tets_of_vertex}, materials);
    for (std::size_t s = 0; s < vertices.size(); ++s) sources[s].position_mm = mesh.points_mm[vertices[s]];
    std::fill(weight.begin(), weight.end(), 0.0);
    const double scale = kMatchWeight * mean_diagonal(stiffness);
    for (const Match& match : match_points(sources, index)) {
      const VertexId v = vertices[match.source];
      if (!is_on_its_side(mesh, topology, field, v, match.target_mm)) continue;
      weight[v] = scale * match.confidence;
      wanted[v] = match.target_mm - mesh.points_mm[v];
    }
    std::fill(u.begin(), u.end(), Vec3{});
    const SolverOptions solver{kTolerance, kMaxSolverIterations, {}, stage.cancel_token()};
    solve_regularized(stiffness, weight, wanted, u, solver);
    stage.check_cancelled();
    before = mesh.points_mm;
    goals = mesh.points_mm;
    for (std::size_t v = 0; v < part.vertices; ++v) goals[v] += u[v];
    advance_all(mesh, topology, guard, goals, kGuardSweeps, stage);
    relax_interior(mesh, topology, guard, stage);
    stage.at(static_cast<double>(iteration + 1) / iterations);
    const double moved = mean_move(before, mesh, vertices);
    if (moved < near_mm) break;
  }
}

}  // namespace anatomesh
