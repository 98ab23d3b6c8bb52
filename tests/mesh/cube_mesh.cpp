#include "mesh/cube_mesh.h"

#include <algorithm>
#include <utility>

namespace anatomesh::testing {

VertexId cube_mesh_vertex(std::array<int, 3> cubes, int x, int y, int z) {
  return static_cast<VertexId>(x + (cubes[0] + 1) * (y + (cubes[1] + 1) * z));
}

namespace {

/// The six ways from one corner of a cube to the opposite one along three edges.
void cut_cube(TissueMesh& mesh, std::array<int, 3> cubes, std::array<int, 3> at, TissueId tissue) {
  std::array<std::size_t, 3> axes = {0, 1, 2};
  do {
    std::array<int, 3> corner = at;
    std::array<VertexId, 4> tet = {cube_mesh_vertex(cubes, corner[0], corner[1], corner[2])};
    for (std::size_t n = 0; n < 3; ++n) {
      ++corner[axes[n]];
      tet[n + 1] = cube_mesh_vertex(cubes, corner[0], corner[1], corner[2]);
    }
    const bool positive = axes == std::array<std::size_t, 3>{0, 1, 2} || axes == std::array<std::size_t, 3>{1, 2, 0} ||
                          axes == std::array<std::size_t, 3>{2, 0, 1};
    if (!positive) std::swap(tet[2], tet[3]);
    mesh.tets.push_back(tet);
    mesh.tissues.push_back(tissue);
  } while (std::next_permutation(axes.begin(), axes.end()));
}

}  // namespace

TissueMesh cube_mesh(std::array<int, 3> cubes, const std::function<int(int i, int j, int k)>& tissue_at) {
  TissueMesh mesh;
  for (int z = 0; z <= cubes[2]; ++z) {
    for (int y = 0; y <= cubes[1]; ++y) {
      for (int x = 0; x <= cubes[0]; ++x)
        mesh.points_mm.push_back({static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)});
    }
  }
  for (int k = 0; k < cubes[2]; ++k) {
    for (int j = 0; j < cubes[1]; ++j) {
      for (int i = 0; i < cubes[0]; ++i) cut_cube(mesh, cubes, {i, j, k}, static_cast<TissueId>(tissue_at(i, j, k)));
    }
  }
  return mesh;
}

}  // namespace anatomesh::testing
