#include "io/mesh_file_fixture.h"

namespace anatomesh::testing {

void expect_same(const TetMesh& actual, const TetMesh& expected) {
  EXPECT_EQ(actual.points_mm, expected.points_mm);
  EXPECT_EQ(actual.tets, expected.tets);
  EXPECT_EQ(actual.labels, expected.labels);
  EXPECT_EQ(actual.names, expected.names);
  EXPECT_EQ(actual.edge_nodes, expected.edge_nodes);
}

std::string with_changed_bytes(std::string bytes, int count, std::mt19937& random) {
  for (int n = 0; n < count; ++n) bytes[random() % bytes.size()] = static_cast<char>(random());
  return bytes;
}

std::string message_of_damaged(const std::filesystem::path& file) {
  try {
    const TetMesh mesh = read_mesh(file);
    EXPECT_EQ(mesh.labels.size(), mesh.tets.size());
    for (const auto& tet : mesh.tets) {
      for (const VertexId vertex : tet) EXPECT_LT(vertex, mesh.points_mm.size());
    }
    EXPECT_TRUE(mesh.edge_nodes.empty() || mesh.edge_nodes.size() == mesh.tets.size());
    for (const auto& nodes : mesh.edge_nodes) {
      for (const VertexId vertex : nodes) EXPECT_LT(vertex, mesh.points_mm.size());
    }
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

}  // namespace anatomesh::testing
