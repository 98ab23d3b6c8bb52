#include "mesh/tissue_topology.h"

#include <algorithm>
#include <numeric>
#include <vector>

#include "mesh/mesh_checks.h"

namespace anatomesh::testing {
namespace {

/// Vertices of a simplex, ascending -> the tissues at it.
using Simplices = std::map<std::vector<VertexId>, std::set<TissueId>>;

Simplices simplices_of(const TissueMesh& mesh) {
  Simplices simplices;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    for (unsigned subset = 1; subset < 16; ++subset) {
      std::vector<VertexId> vertices;
      for (unsigned n = 0; n < 4; ++n) {
        if (subset >> n & 1u) vertices.push_back(mesh.tets[t][n]);
      }
      std::sort(vertices.begin(), vertices.end());
      simplices[vertices].insert(mesh.tissues[t]);
    }
  }
  return simplices;
}

void add_to_euler(const std::vector<VertexId>& simplex, const std::set<TissueId>& set, TissueTopology& topology) {
  const std::vector<TissueId> tissues(set.begin(), set.end());
  for (unsigned subset = 1; subset < (1u << tissues.size()); ++subset) {
    std::set<TissueId> some;
    for (unsigned n = 0; n < tissues.size(); ++n) {
      if (subset >> n & 1u) some.insert(tissues[n]);
    }
    topology.euler[some] += simplex.size() % 2 == 1 ? 1 : -1;
  }
}

class Groups {
 public:
  explicit Groups(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t root(std::size_t i) const { return parent_[i] == i ? i : root(parent_[i]); }
  void join(std::size_t i, std::size_t j) { parent_[root(i)] = root(j); }

 private:
  std::vector<std::size_t> parent_;
};

void count_components(const TissueMesh& mesh, TissueTopology& topology) {
  Groups groups(mesh.tets.size());
  for (const SharedFace& face : all_faces(mesh.tets)) {
    if (face.tets.size() == 2 && mesh.tissues[face.tets[0]] == mesh.tissues[face.tets[1]])
      groups.join(face.tets[0], face.tets[1]);
  }
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) topology.components[mesh.tissues[t]] += groups.root(t) == t;
}

/// The faces of a tissue toward others, as numbers from 0, at each of their edges.
std::map<std::pair<VertexId, VertexId>, std::vector<std::size_t>> surface_edges(const TissueMesh& mesh,
                                                                                TissueId tissue) {
  std::map<std::pair<VertexId, VertexId>, std::vector<std::size_t>> faces_of_edge;
  std::size_t count = 0;
  for (const SharedFace& face : all_faces(mesh.tets)) {
    const bool is_first = mesh.tissues[face.tets.front()] == tissue, is_last = mesh.tissues[face.tets.back()] == tissue;
    if (face.tets.size() != 2 || is_first == is_last) continue;
    const auto [a, b, c] = face.vertices;
    for (const auto& edge : {std::pair{a, b}, std::pair{a, c}, std::pair{b, c}}) faces_of_edge[edge].push_back(count);
    ++count;
  }
  return faces_of_edge;
}

std::size_t count_surface_parts(const TissueMesh& mesh, TissueId tissue) {
  const auto edges = surface_edges(mesh, tissue);
  std::size_t count = 0;
  for (const auto& [edge, faces] : edges) count = std::max(count, faces.back() + 1);
  Groups groups(count);
  for (const auto& [edge, faces] : edges) {
    for (const std::size_t f : faces) groups.join(f, faces[0]);
  }
  std::size_t parts = 0;
  for (std::size_t f = 0; f < count; ++f) parts += groups.root(f) == f;
  return parts;
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const TissueTopology& topology) {
  for (const auto& [tissues, euler] : topology.euler) {
    out << "\nEuler number at";
    for (const TissueId t : tissues) out << ' ' << t;
    out << ": " << euler;
  }
  for (const auto& [t, components] : topology.components) {
    out << "\ntissue " << t << ": " << components << " components, " << topology.surface_parts.at(t)
        << " surface parts";
  }
  return out << '\n';
}

TissueTopology topology_of(const TissueMesh& mesh) {
  TissueTopology topology;
  for (const auto& [simplex, tissues] : simplices_of(mesh)) add_to_euler(simplex, tissues, topology);
  count_components(mesh, topology);
  for (const TissueId t : std::set<TissueId>(mesh.tissues.begin(), mesh.tissues.end()))
    topology.surface_parts[t] = count_surface_parts(mesh, t);
  return topology;
}

std::set<TissueId> nonmanifold_tissues(const TissueMesh& mesh) {
  std::set<TissueId> found;
  for (const TissueId t : std::set<TissueId>(mesh.tissues.begin(), mesh.tissues.end())) {
    for (const auto& [edge, faces] : surface_edges(mesh, t)) {
      if (faces.size() != 2) found.insert(t);
    }
  }
  return found;
}

std::map<TissueId, double> volumes_of(const TissueMesh& mesh) {
  std::map<TissueId, double> volumes;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    volumes[mesh.tissues[t]] += shape_of(corners_of(mesh.points_mm, mesh.tets[t])).volume;
  return volumes;
}

std::set<std::pair<std::array<TissueId, 2>, std::array<std::array<double, 3>, 3>>> interfaces_of(
    const TissueMesh& mesh) {
  std::set<std::pair<std::array<TissueId, 2>, std::array<std::array<double, 3>, 3>>> interfaces;
  for (const SharedFace& face : all_faces(mesh.tets)) {
    const auto [low, high] = std::minmax(mesh.tissues[face.tets.front()], mesh.tissues[face.tets.back()]);
    if (low == high) continue;
    std::array<std::array<double, 3>, 3> corners;
    for (std::size_t n = 0; n < 3; ++n) {
      const Vec3 p = mesh.points_mm[face.vertices[n]];
      corners[n] = {p.x, p.y, p.z};
    }
    std::sort(corners.begin(), corners.end());
    interfaces.insert({{low, high}, corners});
  }
  return interfaces;
}

}  // namespace anatomesh::testing
