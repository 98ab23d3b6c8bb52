// What the tests of solvers' formats share.
#pragma once

#include <algorithm>
#include <array>

#include "io/mesh_file_fixture.h"

namespace anatomesh::testing {

using SolverFile = MeshFileTest;

/// One file of each solver's format; the last two are a pair.
inline constexpr std::array kSolverFiles = {"mesh.inp", "mesh.bdf", "mesh.feb", "mesh.node", "mesh.ele"};

/// Two tissues that share a face, the larger label first, with names that formats may have to change.
inline TetMesh two_named_tissues() {
  TetMesh mesh = two_uneven_tets(3, 17);
  std::ranges::reverse(mesh.tets);
  std::ranges::reverse(mesh.labels);
  mesh.names[3].name = "Große \"Vene\" <3 & -- co->";
  mesh.names[17].name = "white matter";
  return mesh;
}

}  // namespace anatomesh::testing
