#include "mesh/mesh_editor.h"

#include <algorithm>
#include <iterator>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "mesh/adjacency.h"
#include "mesh/tet_shape.h"

namespace anatomesh {

MeshEditor::MeshEditor(TissueMesh mesh) : mesh_(std::move(mesh)) {
  VertexLists<TetId> lists = tets_of_vertices(mesh_.points_mm.size(), mesh_.tets);
  stars_.resize(lists.size());
  for (std::size_t v = 0; v < stars_.size(); ++v) {
    const std::uint32_t count = lists.begin[v + 1] - lists.begin[v];
    stars_[v] = {lists.begin[v], count, count};
  }
  incident_ = std::move(lists.items);
  tissue_tets_ = anatomesh::tissue_tets(mesh_);
  tissues_at_.resize(stars_.size());
  is_outer_.resize(stars_.size());
  changed_at_.assign(stars_.size(), 0);
  parallel_for(stars_.size(), [&](std::size_t v) {
    tissues_at_[v] = count_tissues(static_cast<VertexId>(v));
    is_outer_[v] = lies_on_bare_face(static_cast<VertexId>(v));
  });
}

std::uint8_t MeshEditor::count_tissues(VertexId v) const {
  constexpr std::size_t kMany = 8;
  std::array<TissueId, kMany> seen;
  std::size_t count = 0;
  for (const TetId t : tets_at(v)) {
    const auto end = seen.begin() + count;
    if (count < kMany && std::find(seen.begin(), end, mesh_.tissues[t]) == end) seen[count++] = mesh_.tissues[t];
  }
  return static_cast<std::uint8_t>(count);
}

// A vertex inside has a ball of tetrahedra around it: each edge opposite to it is there twice, in opposite directions,
// and numbers that change their sign with the direction add up to zero.
bool MeshEditor::lies_on_bare_face(VertexId v) const {
  const auto hash = [](VertexId x) {
    const std::uint64_t h = (std::uint64_t{x} + 1) * 0x9e3779b97f4a7c15u;
    return h ^ (h >> 29u);
  };
  const auto directed = [](std::uint64_t x, std::uint64_t y) { return x * y * (y - x); };
  std::uint64_t sum = 0;
  for (const TetId t : tets_at(v)) {
    const auto others = corners_after(mesh_.tets[t], v);
    const std::uint64_t x = hash(others[0]), y = hash(others[1]), z = hash(others[2]);
    sum += directed(x, y) + directed(y, z) + directed(z, x);
  }
  return sum != 0;
}

TissueMesh MeshEditor::result() const {
  std::vector<VertexId> same(vertex_count());
  std::iota(same.begin(), same.end(), VertexId{0});
  TissueMesh all = living(same);
  all.points_mm = mesh_.points_mm;
  return with_cushion_last(all);
}

TissueMesh MeshEditor::living(std::span<const VertexId> numbers) const {
  TissueMesh living;
  for (TetId t = 0; t < mesh_.tets.size(); ++t) {
    if (!is_alive(t)) continue;
    const auto& [a, b, c, d] = mesh_.tets[t];
    living.tets.push_back({numbers[a], numbers[b], numbers[c], numbers[d]});
    living.tissues.push_back(mesh_.tissues[t]);
  }
  return living;
}

void MeshEditor::mark(VertexId v) { clock_ = changed_at_[v] = 1; }

void MeshEditor::attach(VertexId v, TetId t) {
  Star& star = stars_[v];
  if (star.count == star.capacity) {  // on to a place twice as large at the end
    const std::uint32_t begin = static_cast<std::uint32_t>(incident_.size()), capacity = 2 * star.capacity + 8;
    incident_.resize(begin + capacity);
    std::copy_n(incident_.begin() + star.begin, star.count, incident_.begin() + begin);
    star = {begin, star.count, capacity};
  }
  incident_[star.begin + star.count++] = t;
}

void MeshEditor::detach(VertexId v, TetId t) {
  Star& star = stars_[v];
  TetId* const first = incident_.data() + star.begin;
  *std::find(first, first + star.count, t) = first[star.count - 1];
  --star.count;
}

void MeshEditor::kill(TetId t) {
  for (const VertexId v : mesh_.tets[t]) detach(v, t);
  if (mesh_.tissues[t] != 0) --tissue_tets_;
  mesh_.tets[t][0] = kDead;
  free_.push_back(t);
}

void MeshEditor::add(const std::array<VertexId, 4>& tet, TissueId tissue) {
  auto t = static_cast<TetId>(mesh_.tets.size());
  if (free_.empty()) {
    mesh_.tets.push_back(tet);
    mesh_.tissues.push_back(tissue);
  } else {
    t = free_.back();
    free_.pop_back();
    mesh_.tets[t] = tet;
    mesh_.tissues[t] = tissue;
  }
  ++clock_;
  for (const VertexId v : tet) {
    attach(v, t);
    changed_at_[v] = clock_;
  }
  if (tissue != 0) ++tissue_tets_;
}

void MeshEditor::move(VertexId v, Vec3 p) {
  mesh_.points_mm[v] = p;
  ++clock_;
  for (const TetId t : tets_at(v)) {
    for (const VertexId w : mesh_.tets[t]) changed_at_[w] = clock_;
  }
}

void MeshEditor::collapse(VertexId v, VertexId w) {
  ++clock_;
  while (stars_[v].count > 0) {
    const TetId t = incident_[stars_[v].begin + stars_[v].count - 1];
    auto& tet = mesh_.tets[t];
    for (const VertexId x : tet) changed_at_[x] = clock_;
    if (std::ranges::find(tet, w) != tet.end()) {
      kill(t);
      continue;
    }
    *std::ranges::find(tet, v) = w;
    --stars_[v].count;
    attach(w, t);
  }
}

void MeshEditor::replace(std::span<const TetId> old, std::span<const std::array<VertexId, 4>> fresh, TissueId tissue) {
  for (const TetId t : old) kill(t);
  for (const auto& tet : fresh) add(tet, tissue);
}

VertexId MeshEditor::split(VertexId a, VertexId b, Vec3 at) {
  std::vector<TetId> ring;
  std::ranges::copy_if(tets_at(a), std::back_inserter(ring),
                       [&](TetId t) { return std::ranges::find(mesh_.tets[t], b) != mesh_.tets[t].end(); });
  const VertexId m = add_vertex(at);
  for (const TetId t : ring) {
    std::array<std::array<VertexId, 4>, 2> halves = {mesh_.tets[t], mesh_.tets[t]};
    *std::ranges::find(halves[0], a) = m;
    *std::ranges::find(halves[1], b) = m;
    replace(std::array{t}, halves, mesh_.tissues[t]);
  }
  tissues_at_[m] = count_tissues(m);
  is_outer_[m] = lies_on_bare_face(m);
  return m;
}

VertexId MeshEditor::add_vertex(Vec3 p) {
  mesh_.points_mm.push_back(p);
  stars_.emplace_back();
  tissues_at_.push_back(0);
  is_outer_.push_back(0);
  changed_at_.push_back(clock_);
  return static_cast<VertexId>(stars_.size() - 1);
}

}  // namespace anatomesh
