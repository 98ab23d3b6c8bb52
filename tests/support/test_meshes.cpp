#include "support/test_meshes.h"

namespace anatomesh::testing {

TetMesh single_tet(const std::array<Vec3, 4>& corners) {
  return {{corners.begin(), corners.end()}, {{0, 1, 2, 3}}, {1}};
}

TetMesh corner_tet() { return single_tet({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}); }

TetMesh two_tets(Label first, Label second) {
  TetMesh mesh = corner_tet();
  mesh.points_mm.push_back({1, 1, 1});
  mesh.tets.push_back({1, 4, 2, 3});
  mesh.labels = {first, second};
  return mesh;
}

TetMesh two_uneven_tets(Label first, Label second) {
  TetMesh mesh = two_tets(first, second);
  mesh.points_mm[3].z = 1.0 / 3;
  mesh.points_mm[4].z = 1e-9;
  return mesh;
}

}  // namespace anatomesh::testing
