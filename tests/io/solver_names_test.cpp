#include "io/solver_fixture.h"

namespace anatomesh::testing {
namespace {

using SolverNames = SolverFile;

TEST_F(SolverNames, ComeBackAsTheyWere) {
  const TetMesh mesh = two_named_tissues();
  for (const std::string name : kSolverFiles) {
    write_mesh(in_folder(name), mesh);
    EXPECT_EQ(read_mesh(in_folder(name)).names, mesh.names) << name;
  }
}

}  // namespace
}  // namespace anatomesh::testing
