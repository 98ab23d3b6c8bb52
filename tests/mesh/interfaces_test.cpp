#include "anatomesh/interfaces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>

#include "anatomesh/errors.h"
#include "base/vec.h"
#include "mesh/cube_mesh.h"

namespace anatomesh {
namespace {

/// Cubes of 3 x 3 x 3, by label: 5 left, 2 right of the middle, 9 in it.
TetMesh three_labels() {
  const TissueMesh cubes = testing::cube_mesh({3, 3, 3}, [](int i, int j, int k) {
    return i == 1 && j == 1 && k == 1 ? 9 : i < 1 ? 5 : 2;
  });
  TetMesh mesh{cubes.points_mm, cubes.tets, {}};
  mesh.labels.assign(cubes.tissues.begin(), cubes.tissues.end());
  return mesh;
}

TEST(Interfaces, AreTheFacesBetweenLabels) {
  const TetMesh mesh = three_labels();
  std::map<std::set<VertexId>, std::vector<TetId>> tets_of_face;
  for (TetId t = 0; t < mesh.tets.size(); ++t) {
    for (std::size_t c = 0; c < 4; ++c) {
      std::set<VertexId> face(mesh.tets[t].begin(), mesh.tets[t].end());
      face.erase(mesh.tets[t][c]);
      tets_of_face[face].push_back(t);
    }
  }
  std::size_t listed = 0;
  for (const Interface& i : interfaces_of(mesh)) {
    EXPECT_TRUE(i.outside == 0 || i.inside < i.outside);
    listed += i.faces.size();
    for (const TetFace face : i.faces) {
      const auto corners = corners_of(mesh, face);
      const auto& sharing = tets_of_face.at({corners.begin(), corners.end()});
      EXPECT_EQ(mesh.labels[face.tet], i.inside);
      if (i.outside == 0) {
        EXPECT_EQ(sharing, std::vector<TetId>{face.tet});
      } else {
        EXPECT_EQ(mesh.labels[sharing[0] == face.tet ? sharing[1] : sharing[0]], i.outside);
      }
    }
  }
  std::size_t expected = 0;
  for (const auto& [face, tets] : tets_of_face)
    expected += tets.size() == 1 || mesh.labels[tets[0]] != mesh.labels[tets[1]];
  EXPECT_EQ(listed, expected);
}

TEST(Interfaces, FacesPointOutOfTheirTetrahedra) {
  const TetMesh mesh = three_labels();
  for (const Interface& i : interfaces_of(mesh)) {
    for (const TetFace face : i.faces) {
      const auto [a, b, c] = corners_of(mesh, face);
      const Vec3 opposite = mesh.points_mm[mesh.tets[face.tet][face.opposite]] - mesh.points_mm[a];
      const Vec3 normal = cross(mesh.points_mm[b] - mesh.points_mm[a], mesh.points_mm[c] - mesh.points_mm[a]);
      EXPECT_LT(dot(normal, opposite), 0);
    }
  }
}

TEST(Interfaces, AreSorted) {
  std::vector<std::pair<Label, Label>> pairs;
  for (const Interface& i : interfaces_of(three_labels())) {
    pairs.emplace_back(i.inside, i.outside);
    EXPECT_TRUE(std::ranges::is_sorted(i.faces, {}, &TetFace::tet));
  }
  EXPECT_EQ(pairs, (std::vector<std::pair<Label, Label>>{{2, 0}, {2, 5}, {2, 9}, {5, 0}, {5, 9}}));
}

TEST(Interfaces, NeedALabelEach) {
  TetMesh mesh = three_labels();
  mesh.labels.pop_back();
  EXPECT_THROW(interfaces_of(mesh), InvalidInput);
  EXPECT_TRUE(interfaces_of(TetMesh{}).empty());
}

// A face of three tetrahedra, which no sound mesh has.
TEST(Interfaces, FaceOfManyLiesOnTheSkinOfEach) {
  TetMesh mesh;
  mesh.points_mm = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, 2}, {0, 0, 3}};
  mesh.tets = {{0, 1, 2, 3}, {0, 1, 2, 4}, {0, 1, 2, 5}};
  mesh.labels = {1, 1, 2};
  const auto interfaces = interfaces_of(mesh);
  ASSERT_EQ(interfaces.size(), 2u);
  EXPECT_EQ(interfaces[0].faces.size(), 8u);
  EXPECT_EQ(interfaces[1].faces.size(), 4u);
}

}  // namespace
}  // namespace anatomesh
