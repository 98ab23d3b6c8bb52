#include "mesh/adjacency.h"

#include <algorithm>

#include "base/parallel.h"

namespace anatomesh {
namespace {

// Builds lists of any length: gather(v, list) fills the list of one vertex.
template <class Item, class Gather>
VertexLists<Item> gather_lists(std::size_t vertex_count, const Gather& gather) {
  constexpr std::size_t kGrain = 4096;
  std::vector<std::vector<Item>> blocks((vertex_count + kGrain - 1) / kGrain);
  VertexLists<Item> lists;
  lists.begin.assign(vertex_count + 1, 0);
  parallel_blocks(vertex_count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Item> list;
    for (std::size_t v = begin; v < end; ++v) {
      list.clear();
      gather(v, list);
      std::sort(list.begin(), list.end());
      list.erase(std::unique(list.begin(), list.end()), list.end());
      lists.begin[v + 1] = static_cast<std::uint32_t>(list.size());
      blocks[begin / kGrain].insert(blocks[begin / kGrain].end(), list.begin(), list.end());
    }
  });
  for (std::size_t v = 0; v < vertex_count; ++v) lists.begin[v + 1] += lists.begin[v];
  lists.items.resize(lists.begin.back());
  parallel_for(
      blocks.size(),
      [&](std::size_t b) {
        std::copy(blocks[b].begin(), blocks[b].end(), lists.items.begin() + lists.begin[b * kGrain]);
      },
      1);
  return lists;
}

}  // namespace

VertexLists<TetId> tets_of_vertices(std::size_t vertex_count, std::span<const std::array<VertexId, 4>> tets) {
  VertexLists<TetId> lists;
  lists.begin.assign(vertex_count + 1, 0);
  for (const auto& tet : tets) {
    for (const VertexId v : tet) ++lists.begin[v + 1];
  }
  for (std::size_t v = 0; v < vertex_count; ++v) lists.begin[v + 1] += lists.begin[v];
  lists.items.resize(lists.begin.back());
  std::vector<std::uint32_t> next(lists.begin.begin(), lists.begin.end() - 1);
  for (TetId t = 0; t < tets.size(); ++t) {
    for (const VertexId v : tets[t]) lists.items[next[v]++] = t;
  }
  return lists;
}

VertexLists<VertexId> neighbours_of_vertices(const VertexLists<TetId>& tets_of_vertex,
                                             std::span<const std::array<VertexId, 4>> tets) {
  return gather_lists<VertexId>(tets_of_vertex.size(), [&](std::size_t v, std::vector<VertexId>& list) {
    for (const TetId t : tets_of_vertex[v]) {
      for (const VertexId w : tets[t]) {
        if (w != v) list.push_back(w);
      }
    }
  });
}

VertexLists<TissueId> tissues_of_vertices(const VertexLists<TetId>& tets_of_vertex, std::span<const TissueId> tissues) {
  return gather_lists<TissueId>(tets_of_vertex.size(), [&](std::size_t v, std::vector<TissueId>& list) {
    for (const TetId t : tets_of_vertex[v]) list.push_back(tissues[t]);
  });
}

VertexLists<VertexId> interface_neighbours(const VertexLists<TetId>& tets_of_vertex,
                                           const VertexLists<TissueId>& tissues_of_vertex,
                                           std::span<const std::array<VertexId, 4>> tets,
                                           std::span<const TissueId> tissues) {
  return gather_lists<VertexId>(tets_of_vertex.size(), [&](std::size_t v, std::vector<VertexId>& list) {
    const std::size_t wanted = tissues_of_vertex[v].size();
    if (wanted < 2) return;
    std::vector<std::pair<VertexId, TissueId>> seen;
    for (const TetId t : tets_of_vertex[v]) {
      for (const VertexId w : tets[t]) {
        if (w != v) seen.emplace_back(w, tissues[t]);
      }
    }
    std::sort(seen.begin(), seen.end());
    seen.erase(std::unique(seen.begin(), seen.end()), seen.end());
    for (std::size_t first = 0, last = 0; first < seen.size(); first = last) {
      while (last < seen.size() && seen[last].first == seen[first].first) ++last;
      if (last - first == wanted) list.push_back(seen[first].first);
    }
  });
}

MeshTopology make_topology(const TissueMesh& mesh) {
  MeshTopology topology;
  topology.tets_of_vertex = tets_of_vertices(mesh.points_mm.size(), mesh.tets);
  topology.neighbours = neighbours_of_vertices(topology.tets_of_vertex, mesh.tets);
  topology.tissues_of_vertex = tissues_of_vertices(topology.tets_of_vertex, mesh.tissues);
  topology.interface_neighbours =
      interface_neighbours(topology.tets_of_vertex, topology.tissues_of_vertex, mesh.tets, mesh.tissues);
  topology.colours = colour_classes(topology.neighbours);
  return topology;
}

std::vector<std::vector<VertexId>> colour_classes(const VertexLists<VertexId>& neighbours) {
  constexpr std::uint16_t kNone = 0xffff;
  std::vector<std::uint16_t> colour(neighbours.size(), kNone);
  std::vector<std::vector<VertexId>> classes;
  std::vector<VertexId> taken_by;  // by colour: the vertex that last saw it at a neighbour
  for (VertexId v = 0; v < neighbours.size(); ++v) {
    for (const VertexId w : neighbours[v]) {
      if (colour[w] != kNone) taken_by[colour[w]] = v;
    }
    std::size_t c = 0;
    while (c < classes.size() && taken_by[c] == v) ++c;
    if (c == classes.size()) {
      classes.emplace_back();
      taken_by.push_back(static_cast<VertexId>(-1));
    }
    colour[v] = static_cast<std::uint16_t>(c);
    classes[c].push_back(v);
  }
  return classes;
}

}  // namespace anatomesh
