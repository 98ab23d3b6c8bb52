#include "io/set_names.h"

#include <gtest/gtest.h>

#include <utility>

namespace anatomesh::testing {
namespace {

TetMesh labelled(std::initializer_list<Label> labels) {
  TetMesh mesh;
  for (const Label label : labels) {
    mesh.tets.push_back({0, 1, 2, 3});
    mesh.labels.push_back(label);
  }
  return mesh;
}

void name(TetMesh& mesh, Label label, std::string text) { mesh.names[label].name = std::move(text); }

using Names = std::map<Label, std::string>;

TEST(SetNames, ThoseOfTheTableOrTheLabel) {
  TetMesh mesh = labelled({7, 9, 7});
  name(mesh, 9, " white matter ");
  name(mesh, 11, "not in the mesh");
  EXPECT_EQ(set_names(mesh, {}), (Names{{7, "label_7"}, {9, "white matter"}}));
  EXPECT_EQ(set_names(mesh, {.identifier = true}), (Names{{7, "label_7"}, {9, "white_matter"}}));
}

TEST(SetNames, AreMadeToFitTheRule) {
  TetMesh mesh = labelled({1, 2, 3});
  name(mesh, 1, "3rd \"ventricle\"\n");
  name(mesh, 2, "Große Vene");
  name(mesh, 3, std::string(22, 'x') + "äöü");
  EXPECT_EQ(set_names(mesh, {.identifier = true}).at(1), "label_3rd__ventricle_");
  EXPECT_EQ(set_names(mesh, {}).at(2), "Große Vene");
  EXPECT_EQ(set_names(mesh, {.identifier = true}).at(2), "Gro__e_Vene");
  EXPECT_EQ(set_names(mesh, {.most_bytes = 25}).at(3), std::string(22, 'x') + "ä");
}

TEST(SetNames, AreAllDifferent) {
  TetMesh mesh = labelled({1, 2, 3, 4, 5});
  for (const Label label : {1U, 2U}) name(mesh, label, "a");
  name(mesh, 3, "a_1");
  name(mesh, 4, "A");
  name(mesh, 5, std::string(50, 'z'));
  EXPECT_EQ(set_names(mesh, {}), (Names{{1, "a_1_"}, {2, "a_2"}, {3, "a_1"}, {4, "A"}, {5, std::string(50, 'z')}}));
  name(mesh, 5, "a");
  EXPECT_EQ(set_names(mesh, {.tells_case_apart = false}),
            (Names{{1, "a_1_"}, {2, "a_2"}, {3, "a_1"}, {4, "A_4"}, {5, "a_5"}}));
  name(mesh, 1, std::string(50, 'z'));
  name(mesh, 2, std::string(50, 'z'));
  EXPECT_EQ(set_names(mesh, {.most_bytes = 24}).at(2), std::string(22, 'z') + "_2");
}

}  // namespace
}  // namespace anatomesh::testing
