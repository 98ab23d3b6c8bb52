// The tetrahedra of a refined lattice as a plain mesh, for tests.
#pragma once

#include <vector>

#include "lattice/red_green.h"
#include "mesh/mesh_checks.h"

namespace anatomesh::testing {

/// All leaves of the lattice, in the order of their levels.
std::vector<TetRef> leaves_of(const RedGreenLattice& lattice);

/// Leaves and green parts, positively oriented, in units of the finest level.
struct LatticeMesh {
  std::vector<Vec3> points;
  std::vector<Tet> tets;
};
LatticeMesh mesh_of(const RedGreenLattice& lattice);

}  // namespace anatomesh::testing
