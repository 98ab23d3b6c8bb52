#include "mesh/adjacency.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "base/parallel.h"

namespace anatomesh {
namespace {

// Marks for numbers below some bound, all of which are taken back at once.
class Marks {
 public:
  void start(std::size_t bound) {
    if (mark_.size() < bound || ++current_ == 0) {
      mark_.assign(bound, 0);
      current_ = 1;
    }
  }
  /// Whether it has not been marked since the start.
  bool add(std::size_t n) {
    if (mark_[n] == current_) return false;
    mark_[n] = current_;
    return true;
  }

 private:
  std::vector<std::uint32_t> mark_;
  std::uint32_t current_ = 0;
};

// Builds lists of any length: gather(v, list) appends the list of one vertex, each item once, which is sorted then.
template <class Item, class Gather>
VertexLists<Item> gather_lists(std::size_t vertex_count, const Gather& gather) {
  constexpr std::size_t kGrain = 4096;
  std::vector<std::vector<Item>> blocks((vertex_count + kGrain - 1) / kGrain);
  VertexLists<Item> lists;
  lists.begin.assign(vertex_count + 1, 0);
  parallel_blocks(vertex_count, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<Item>& list = blocks[begin / kGrain];
    for (std::size_t v = begin; v < end; ++v) {
      const std::size_t first = list.size();
      gather(v, list);
      std::sort(list.begin() + static_cast<std::ptrdiff_t>(first), list.end());
      lists.begin[v + 1] = static_cast<std::uint32_t>(list.size() - first);
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

// Long enough to stay in the cache, short enough for many threads to share the runs of a colour.
VertexId run_length(std::size_t vertices) {
  return static_cast<VertexId>(std::clamp<std::size_t>(vertices / 512, 16, 256));
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
    static thread_local Marks seen;
    seen.start(tets_of_vertex.size());
    seen.add(v);
    for (const TetId t : tets_of_vertex[v]) {
      for (const VertexId w : tets[t]) {
        if (seen.add(w)) list.push_back(w);
      }
    }
  });
}

VertexLists<TissueId> tissues_of_vertices(const VertexLists<TetId>& tets_of_vertex, std::span<const TissueId> tissues) {
  return gather_lists<TissueId>(tets_of_vertex.size(), [&](std::size_t v, std::vector<TissueId>& list) {
    const auto first = static_cast<std::ptrdiff_t>(list.size());
    for (const TetId t : tets_of_vertex[v]) {
      if (std::find(list.begin() + first, list.end(), tissues[t]) == list.end()) list.push_back(tissues[t]);
    }
  });
}

VertexLists<VertexId> interface_neighbours(const VertexLists<TetId>& tets_of_vertex,
                                           const VertexLists<TissueId>& tissues_of_vertex,
                                           std::span<const std::array<VertexId, 4>> tets,
                                           std::span<const TissueId> tissues) {
  return gather_lists<VertexId>(tets_of_vertex.size(), [&](std::size_t v, std::vector<VertexId>& list) {
    const std::span<const TissueId> here = tissues_of_vertex[v];
    if (here.size() < 2) return;
    static thread_local std::vector<std::uint8_t> tissues_at;  // the edge to each vertex: how many
    tissues_at.resize(tets_of_vertex.size());
    const auto first = static_cast<std::ptrdiff_t>(list.size());
    for (const TissueId tissue : here) {
      static thread_local Marks seen;
      seen.start(tets_of_vertex.size());
      seen.add(v);
      for (const TetId t : tets_of_vertex[v]) {
        if (tissues[t] != tissue) continue;
        for (const VertexId w : tets[t]) {
          if (!seen.add(w)) continue;
          if (tissues_at[w] == 0) list.push_back(w);
          if (tissues_at[w] < 0xff) ++tissues_at[w];
        }
      }
    }
    const auto has_fewer = [&](VertexId w) { return std::exchange(tissues_at[w], std::uint8_t{0}) < here.size(); };
    list.erase(std::remove_if(list.begin() + first, list.end(), has_fewer), list.end());
  });
}

MeshTopology make_topology(const TissueMesh& mesh) {
  MeshTopology topology;
  topology.tets_of_vertex = tets_of_vertices(mesh.points_mm.size(), mesh.tets);
  topology.neighbours = neighbours_of_vertices(topology.tets_of_vertex, mesh.tets);
  topology.tissues_of_vertex = tissues_of_vertices(topology.tets_of_vertex, mesh.tissues);
  topology.interface_neighbours =
      interface_neighbours(topology.tets_of_vertex, topology.tissues_of_vertex, mesh.tets, mesh.tissues);
  topology.colours = colour_classes(topology.neighbours, run_length(mesh.points_mm.size()));
  return topology;
}

std::vector<std::vector<VertexRun>> colour_classes(const VertexLists<VertexId>& neighbours, VertexId length) {
  const auto vertices = static_cast<VertexId>(neighbours.size());
  const VertexId runs = (vertices + length - 1) / length;
  std::vector<std::vector<VertexId>> earlier(runs);  // by run: the runs before it that it touches
  parallel_for(
      runs,
      [&](std::size_t r) {
        const auto begin = static_cast<VertexId>(r) * length;
        for (VertexId v = begin; v < std::min(vertices, begin + length); ++v) {
          for (const VertexId w : neighbours[v]) {
            if (w < begin && (earlier[r].empty() || earlier[r].back() != w / length)) earlier[r].push_back(w / length);
          }
        }
      },
      1);
  std::vector<std::size_t> colour(runs);
  std::vector<std::vector<VertexRun>> classes;
  std::vector<VertexId> taken_by;  // by colour: the last run that touches one of it
  for (VertexId r = 0; r < runs; ++r) {
    for (const VertexId other : earlier[r]) taken_by[colour[other]] = r;
    std::size_t c = 0;
    while (c < classes.size() && taken_by[c] == r) ++c;
    if (c == classes.size()) {
      classes.emplace_back();
      taken_by.push_back(static_cast<VertexId>(-1));
    }
    colour[r] = c;
    classes[c].push_back({r * length, std::min(vertices, (r + 1) * length)});
  }
  return classes;
}

}  // namespace anatomesh
