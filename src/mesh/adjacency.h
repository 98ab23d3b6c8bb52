// What touches what in a mesh, as flat arrays.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "image/tissue_image.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// Lists of items for each vertex, one after the other: those of vertex v are items[begin[v]] up to
/// items[begin[v + 1]] (excluded).
template <class Item>
struct VertexLists {
  std::vector<std::uint32_t> begin;
  std::vector<Item> items;

  std::size_t size() const { return begin.empty() ? 0 : begin.size() - 1; }
  std::span<const Item> operator[](std::size_t v) const { return {items.data() + begin[v], begin[v + 1] - begin[v]}; }
};

/// Tetrahedra at each vertex, in ascending order. Cost: linear.
VertexLists<TetId> tets_of_vertices(std::size_t vertex_count, std::span<const std::array<VertexId, 4>> tets);

/// Vertices that share an edge with each vertex, in ascending order. Cost: linear.
VertexLists<VertexId> neighbours_of_vertices(const VertexLists<TetId>& tets_of_vertex,
                                             std::span<const std::array<VertexId, 4>> tets);

/// Tissues of the tetrahedra at each vertex (background included), each once, ascending. A vertex with two
/// or more lies on an interface. Cost: linear.
VertexLists<TissueId> tissues_of_vertices(const VertexLists<TetId>& tets_of_vertex, std::span<const TissueId> tissues);

/// Vertices of consecutive numbers: [begin, end).
struct VertexRun {
  VertexId begin = 0, end = 0;
  bool operator==(const VertexRun&) const = default;
};

/// All vertices in runs of up to `length`, and the runs grouped so that vertices of two runs of a group are never
/// neighbours: all runs of a group can be worked on at once, each in the order of its vertices. Where numbers follow
/// each other in space, a run stays in the processor's cache. Greedy in order of number: the groups depend on the mesh
/// only.
std::vector<std::vector<VertexRun>> colour_classes(const VertexLists<VertexId>& neighbours, VertexId length);

/// For each interface vertex the vertices joined to it by an edge around which all of its tissues meet: its neighbours
/// in the interface surface or, where three or more tissues meet, along the junction line.
VertexLists<VertexId> interface_neighbours(const VertexLists<TetId>& tets_of_vertex,
                                           const VertexLists<TissueId>& tissues_of_vertex,
                                           std::span<const std::array<VertexId, 4>> tets,
                                           std::span<const TissueId> tissues);

/// All of the above for one mesh; stays true while vertices move.
struct MeshTopology {
  VertexLists<TetId> tets_of_vertex;
  VertexLists<VertexId> neighbours;
  VertexLists<TissueId> tissues_of_vertex;
  VertexLists<VertexId> interface_neighbours;
  std::vector<std::vector<VertexRun>> colours;

  bool on_interface(VertexId v) const { return tissues_of_vertex[v].size() > 1; }
  /// Only background around it: the far side of the cushion.
  bool outside(VertexId v) const { return tissues_of_vertex[v].size() == 1 && tissues_of_vertex[v][0] == 0; }
};
MeshTopology make_topology(const TissueMesh& mesh);

}  // namespace anatomesh
