// What the tests of solvers' formats share.
#pragma once

#include <string>

#include "anatomesh/errors.h"
#include "anatomesh/io.h"
#include "io/io_fixture.h"

namespace anatomesh::testing {

class SolverFile : public IoTest {
 protected:
  TetMesh mesh_in(const std::string& name, const std::string& bytes) const { return read_mesh(put(name, bytes)); }

  template <typename Expected>
  std::string refused(const std::string& name, const std::string& bytes) const {
    const auto file = put(name, bytes);
    return message_of<Expected>(file, [&] { read_mesh(file); });
  }

  std::string written(const std::string& name, const TetMesh& mesh) const {
    write_mesh(in_folder(name), mesh);
    return bytes_of(in_folder(name));
  }
};

/// Two tissues that share a face, with names that formats may have to change.
inline TetMesh two_named_tissues() {
  TetMesh mesh;
  mesh.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1.0 / 3}, {1, 1, 1e-9}};
  mesh.tets = {{1, 4, 2, 3}, {0, 1, 2, 3}};
  mesh.labels = {17, 3};
  mesh.names[3].name = "Große \"Vene\" <3 & -- co->";
  mesh.names[17].name = "white matter";
  return mesh;
}

}  // namespace anatomesh::testing
