#include "mesh/edit_in_blocks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <mutex>
#include <set>

#include "base/parallel.h"
#include "base/vec.h"
#include "mesh/cube_mesh.h"
#include "mesh/expect_sound.h"
#include "mesh/mesh_checks.h"

namespace anatomesh {
namespace {

TissueMesh boxes() {
  return testing::cube_mesh({9, 8, 7}, [](int i, int j, int k) {
    const bool inside = std::min({i, j, k}) > 0 && i < 8 && j < 7 && k < 6;
    return !inside ? 0 : i < 4 ? 1 : 2;
  });
}

std::set<std::array<VertexId, 4>> tets_of(const TissueMesh& mesh) { return {mesh.tets.begin(), mesh.tets.end()}; }

TEST(EditInBlocks, EveryTetrahedronIsInOneBlock) {
  const TissueMesh mesh = boxes();
  for (const double share : {0.5, 0.3}) {
    std::vector<char> is_due(mesh.points_mm.size());
    std::size_t tets = 0, blocks = 0;
    std::mutex mutex;
    const TissueMesh same =
        edit_in_blocks(mesh, {500, share}, is_due, [&](MeshEditor& editor, std::span<const VertexId> vertices) {
          const std::lock_guard lock(mutex);
          EXPECT_LE(editor.tet_count(), 500u);
          EXPECT_EQ(editor.vertex_count(), vertices.size());
          tets += editor.tet_count();
          ++blocks;
        });
    EXPECT_EQ(tets, mesh.tets.size());
    EXPECT_GT(blocks, 5u);
    EXPECT_EQ(tets_of(same), tets_of(mesh));
    EXPECT_EQ(same.points_mm, mesh.points_mm);
    EXPECT_EQ(std::ranges::count(is_due, 1), 0) << "nothing was due and nothing has changed";
  }
}

// Of what was due, only what lies on seams stays so, and two ways of cutting have few seams in common.
TEST(EditInBlocks, WorkIsLeftOnSeamsOnly) {
  const TissueMesh mesh = boxes();
  std::vector<char> is_due(mesh.points_mm.size(), 1);
  std::mutex mutex;
  std::vector<int> inside(mesh.points_mm.size());
  const auto count_inside = [&](MeshEditor& editor, std::span<const VertexId> vertices) {
    const std::lock_guard lock(mutex);
    for (VertexId v = 0; v < editor.vertex_count(); ++v) {
      EXPECT_EQ(editor.changed_at(v), is_due[vertices[v]] ? 1u : 0u);
      inside[vertices[v]] += !editor.is_outer(v);
    }
  };
  edit_in_blocks(mesh, {600, 0.5}, is_due, count_inside);
  EXPECT_EQ(std::ranges::max(inside), 1) << "in the inside of one block only";
  for (VertexId v = 0; v < inside.size(); ++v) EXPECT_FALSE(is_due[v] && inside[v]);
  const auto left = std::ranges::count(is_due, 1);
  EXPECT_GT(left, 0);
  edit_in_blocks(mesh, {600, 0.35}, is_due, count_inside);
  EXPECT_LT(std::ranges::count(is_due, 1), left * 3 / 5);
}

/// Collapses and moves all over the blocks.
TissueMesh edited(int threads) {
  const ThreadLimit limit(threads);
  const TissueMesh mesh = boxes();
  std::vector<char> is_due(mesh.points_mm.size(), 1);
  const TissueMesh changed =
      edit_in_blocks(mesh, {700, 0.4}, is_due, [&](MeshEditor& editor, std::span<const VertexId>) {
        for (VertexId v = 0; v < editor.vertex_count(); ++v) {
          if (editor.is_outer(v) || editor.tissues_at(v) > 1 || editor.tets_at(v).empty()) continue;
          const Vec3 from = editor.point(v);
          editor.move(v, from + Vec3{0.05, 0.02, -0.03});
          const auto can_go_to = [&](VertexId w) {
            return std::ranges::all_of(editor.tets_at(v), [&](TetId t) {
              std::array<VertexId, 4> tet = editor.tet(t);
              if (std::ranges::find(tet, w) != tet.end()) return true;
              std::ranges::replace(tet, v, w);
              return dot(editor.point(tet[1]) - editor.point(tet[0]),
                         cross(editor.point(tet[2]) - editor.point(tet[0]),
                               editor.point(tet[3]) - editor.point(tet[0]))) > 1e-6;
            });
          };
          for (const VertexId w : std::array<VertexId, 4>(editor.tet(editor.tets_at(v)[0]))) {
            if (w == v || !can_go_to(w)) continue;
            editor.collapse(v, w);
            break;
          }
        }
      });
  return with_cushion_last(changed);
}

TEST(EditInBlocks, ChangesOfAllBlocksMakeOneSoundMesh) {
  const TissueMesh before = boxes(), after = edited(2);
  EXPECT_LT(after.tets.size(), before.tets.size());
  testing::expect_sound(after.points_mm, after.tets);
  const auto volume = [](const TissueMesh& mesh) { return testing::worst_shape(mesh.points_mm, mesh.tets).volume; };
  EXPECT_NEAR(volume(after), volume(before), 1e-9 * volume(before));
}

TEST(EditInBlocks, DoesNotDependOnTheNumberOfThreads) {
  const TissueMesh one = edited(1), three = edited(3);
  EXPECT_EQ(one.tets, three.tets);
  EXPECT_EQ(one.points_mm, three.points_mm);
  EXPECT_EQ(one.tissues, three.tissues);
}

}  // namespace
}  // namespace anatomesh
