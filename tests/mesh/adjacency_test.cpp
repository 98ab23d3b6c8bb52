#include "mesh/adjacency.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "base/parallel.h"
#include "mesh/cube_mesh.h"
#include "mesh/mesh_checks.h"

namespace anatomesh {
namespace {

using testing::cube_mesh;
using testing::cube_mesh_vertex;

/// Three tissues and background in an irregular pattern.
TissueMesh patchwork() {
  return cube_mesh({5, 4, 3}, [](int i, int j, int k) { return (i * i + 3 * j + 2 * k * i) % 4; });
}

bool has(const std::array<VertexId, 4>& tet, VertexId v) { return std::find(tet.begin(), tet.end(), v) != tet.end(); }

template <class Item>
std::vector<Item> list_of(const VertexLists<Item>& lists, std::size_t v) {
  return {lists[v].begin(), lists[v].end()};
}

template <class Item>
std::vector<Item> as_list(const std::set<Item>& items) {
  return {items.begin(), items.end()};
}

TEST(CubeMesh, IsSound) {
  const TissueMesh mesh = patchwork();
  EXPECT_EQ(mesh.tets.size(), 5u * 4u * 3u * 6u);
  EXPECT_GT(testing::smallest_volume(mesh.points_mm, mesh.tets), 0);
  EXPECT_NEAR(testing::worst_shape(mesh.points_mm, mesh.tets).volume, 60, 1e-9);
  EXPECT_EQ(testing::crowded_faces(mesh.points_mm, mesh.tets), 0u);
  EXPECT_NEAR(testing::area_of(mesh.points_mm, testing::outer_faces(mesh.tets)), 2 * (20 + 15 + 12), 1e-9);
}

TEST(Adjacency, TetsOfVerticesAsByBruteForce) {
  const TissueMesh mesh = patchwork();
  const auto lists = tets_of_vertices(mesh.points_mm.size(), mesh.tets);
  ASSERT_EQ(lists.size(), mesh.points_mm.size());
  for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
    std::vector<TetId> expected;
    for (TetId t = 0; t < mesh.tets.size(); ++t) {
      if (has(mesh.tets[t], v)) expected.push_back(t);
    }
    EXPECT_EQ(list_of(lists, v), expected);
  }
}

TEST(Adjacency, NeighboursAndTissuesAsByBruteForce) {
  const TissueMesh mesh = patchwork();
  const MeshTopology topology = make_topology(mesh);
  for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
    std::set<VertexId> neighbours;
    std::set<TissueId> tissues;
    for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
      if (!has(mesh.tets[t], v)) continue;
      neighbours.insert(mesh.tets[t].begin(), mesh.tets[t].end());
      tissues.insert(mesh.tissues[t]);
    }
    neighbours.erase(v);
    EXPECT_EQ(list_of(topology.neighbours, v), as_list(neighbours));
    EXPECT_EQ(list_of(topology.tissues_of_vertex, v), as_list(tissues));
    EXPECT_EQ(topology.on_interface(v), tissues.size() > 1);
    EXPECT_EQ(topology.outside(v), tissues == std::set<TissueId>{0});
  }
}

TEST(Adjacency, VerticesOfNoTetHaveEmptyLists) {
  TissueMesh mesh = patchwork();
  mesh.points_mm.push_back({9, 9, 9});
  const MeshTopology topology = make_topology(mesh);
  const VertexId lone = static_cast<VertexId>(mesh.points_mm.size() - 1);
  EXPECT_TRUE(topology.tets_of_vertex[lone].empty());
  EXPECT_TRUE(topology.neighbours[lone].empty());
  EXPECT_TRUE(topology.interface_neighbours[lone].empty());
  EXPECT_FALSE(topology.on_interface(lone));
}

TEST(Adjacency, InterfaceNeighboursAsByBruteForce) {
  const TissueMesh mesh = patchwork();
  const MeshTopology topology = make_topology(mesh);
  for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
    std::vector<VertexId> expected;
    for (const VertexId w : topology.neighbours[v]) {
      std::set<TissueId> around;
      for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
        if (has(mesh.tets[t], v) && has(mesh.tets[t], w)) around.insert(mesh.tissues[t]);
      }
      const bool along = around.size() == topology.tissues_of_vertex[v].size();
      if (topology.on_interface(v) && along) expected.push_back(w);
    }
    EXPECT_EQ(list_of(topology.interface_neighbours, v), expected);
  }
}

TEST(Adjacency, NeighboursOnTheFaceOfTwoTouchingCubesStayOnIt) {
  constexpr std::array<int, 3> kCubes = {4, 3, 3};
  const TissueMesh mesh = cube_mesh(kCubes, [](int i, int, int) { return i < 2 ? 1 : 2; });
  const MeshTopology topology = make_topology(mesh);
  for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
    EXPECT_EQ(topology.on_interface(v), mesh.points_mm[v].x == 2);
    for (const VertexId w : topology.interface_neighbours[v]) EXPECT_EQ(mesh.points_mm[w].x, 2);
  }
  EXPECT_EQ(topology.interface_neighbours[cube_mesh_vertex(kCubes, 2, 1, 1)].size(), 6u);
}

TEST(Adjacency, NeighboursOnAJunctionOfThreeStayOnIt) {
  constexpr std::array<int, 3> kCubes = {4, 4, 3};
  const TissueMesh mesh = cube_mesh(kCubes, [](int i, int j, int) { return i < 2 ? 1 : j < 2 ? 2 : 3; });
  const MeshTopology topology = make_topology(mesh);
  const auto on_line = [&](int z) { return cube_mesh_vertex(kCubes, 2, 2, z); };
  EXPECT_EQ(topology.tissues_of_vertex[on_line(1)].size(), 3u);
  EXPECT_EQ(list_of(topology.interface_neighbours, on_line(0)), std::vector{on_line(1)});
  EXPECT_EQ(list_of(topology.interface_neighbours, on_line(1)), (std::vector{on_line(0), on_line(2)}));
  EXPECT_EQ(list_of(topology.interface_neighbours, on_line(3)), std::vector{on_line(2)});
}

TEST(ColourClasses, CoverAllVerticesAndHoldNoNeighboursInTwoRuns) {
  const TissueMesh mesh = patchwork();
  const MeshTopology topology = make_topology(mesh);
  for (const VertexId length : {1u, 7u, 64u}) {
    const auto classes = colour_classes(topology.neighbours, length);
    constexpr std::size_t kNone = 1000;
    std::vector<std::size_t> colour(mesh.points_mm.size(), kNone);
    for (std::size_t c = 0; c < classes.size(); ++c) {
      EXPECT_FALSE(classes[c].empty());
      for (const VertexRun& run : classes[c]) {
        EXPECT_LE(run.end - run.begin, length);
        for (VertexId v = run.begin; v < run.end; ++v) {
          EXPECT_EQ(colour[v], kNone) << "in two runs";
          colour[v] = c;
        }
      }
    }
    EXPECT_EQ(std::count(colour.begin(), colour.end(), kNone), 0);
    for (VertexId v = 0; v < mesh.points_mm.size(); ++v) {
      for (const VertexId w : topology.neighbours[v]) {
        if (v / length != w / length) {
          EXPECT_NE(colour[v], colour[w]);
        }
      }
    }
  }
  EXPECT_LE(colour_classes(topology.neighbours, 1).size(), 15u) << "one more than the most neighbours, at the most";
}

TEST(Adjacency, DoesNotDependOnTheNumberOfThreads) {
  const TissueMesh mesh = cube_mesh({20, 20, 20}, [](int i, int j, int k) { return (i / 3 + j / 2 + k) % 3; });
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return make_topology(mesh);
  };
  const MeshTopology one = with_threads(1), three = with_threads(3);
  EXPECT_EQ(one.neighbours.items, three.neighbours.items);
  EXPECT_EQ(one.interface_neighbours.items, three.interface_neighbours.items);
  EXPECT_EQ(one.tissues_of_vertex.begin, three.tissues_of_vertex.begin);
  EXPECT_EQ(one.colours, three.colours);
}

}  // namespace
}  // namespace anatomesh
