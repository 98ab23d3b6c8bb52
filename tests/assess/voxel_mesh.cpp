#include "voxel_mesh.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <utility>
#include <vector>

#include "base/vec.h"

namespace anatomesh::testing {
namespace {

using Lattice = std::array<int, 3>;  // in half voxels: corners at even numbers
using LatticeTet = std::array<Lattice, 4>;

Lattice corner(int n) { return {2 * (n & 1), n & 2, (n & 4) / 2}; }

std::vector<LatticeTet> tets_of(const std::vector<std::array<int, 4>>& corners) {
  std::vector<LatticeTet> tets;
  for (const auto& t : corners) tets.push_back({corner(t[0]), corner(t[1]), corner(t[2]), corner(t[3])});
  return tets;
}

/// The tetrahedra of a voxel whose corner 0 lies at (0, 0, 0). Corner n: bit a is set on the far side along axis a.
std::vector<LatticeTet> cut_voxel(VoxelCut cut, bool odd) {
  if (cut == VoxelCut::six) {
    return tets_of({{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}});
  }
  if (cut == VoxelCut::five) {
    if (odd) return tets_of({{1, 2, 4, 7}, {0, 1, 2, 4}, {3, 1, 2, 7}, {5, 1, 4, 7}, {6, 2, 4, 7}});
    return tets_of({{0, 3, 5, 6}, {1, 0, 3, 5}, {2, 0, 3, 6}, {4, 0, 5, 6}, {7, 3, 5, 6}});
  }
  std::vector<LatticeTet> tets;
  for (const std::array<int, 4>& side :
       {std::array{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}) {
    tets.push_back({corner(side[0]), corner(side[1]), corner(side[2]), {1, 1, 1}});
    tets.push_back({corner(side[0]), corner(side[2]), corner(side[3]), {1, 1, 1}});
  }
  return tets;
}

void orient(TetMesh& mesh) {
  for (auto& t : mesh.tets) {
    const Vec3 a = mesh.points_mm[t[0]];
    const Vec3 normal = cross(mesh.points_mm[t[1]] - a, mesh.points_mm[t[2]] - a);
    if (dot(normal, mesh.points_mm[t[3]] - a) < 0) std::swap(t[0], t[1]);
  }
}

}  // namespace

TetMesh mesh_of_voxels(const LabelImage& image, VoxelCut cut) {
  TetMesh mesh;
  std::map<Lattice, VertexId> vertices;
  const auto vertex = [&](const Lattice& at) {
    const auto [found, added] = vertices.try_emplace(at, static_cast<VertexId>(mesh.points_mm.size()));
    if (added) {
      Vec3 p;
      for (std::size_t a = 0; a < 3; ++a) p[a] = (at[a] / 2.0 - 0.5) * image.spacing_mm[a];
      mesh.points_mm.push_back(image.direction * p + image.origin_mm);
    }
    return found->second;
  };
  for (std::size_t k = 0; k < image.size[2]; ++k) {
    for (std::size_t j = 0; j < image.size[1]; ++j) {
      for (std::size_t i = 0; i < image.size[0]; ++i) {
        if (image.at(i, j, k) == 0) continue;
        const Lattice base = {2 * static_cast<int>(i), 2 * static_cast<int>(j), 2 * static_cast<int>(k)};
        for (const LatticeTet& tet : cut_voxel(cut, (i + j + k) % 2 == 1)) {
          std::array<VertexId, 4> ids;
          for (std::size_t c = 0; c < 4; ++c) {
            ids[c] = vertex({base[0] + tet[c][0], base[1] + tet[c][1], base[2] + tet[c][2]});
          }
          mesh.tets.push_back(ids);
          mesh.labels.push_back(image.at(i, j, k));
        }
      }
    }
  }
  orient(mesh);
  return mesh;
}

TetMesh jittered(TetMesh mesh, double distance_mm, unsigned seed) {
  std::mt19937 random(seed);
  const auto step = [&] { return distance_mm * (2.0 * static_cast<double>(random()) / 4294967295.0 - 1); };
  for (Vec3& p : mesh.points_mm) {
    for (std::size_t a = 0; a < 3; ++a) p[a] += step();
  }
  return mesh;
}

TetMesh moved(TetMesh mesh, const std::function<Vec3(Vec3)>& to) {
  for (Vec3& p : mesh.points_mm) p = to(p);
  return mesh;
}

}  // namespace anatomesh::testing
