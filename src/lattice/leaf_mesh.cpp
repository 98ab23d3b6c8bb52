#include "lattice/leaf_mesh.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

// Nodes 0 .. 9 of a leaf (vertices, and midpoints of split edges; the first vertex for others), in units of the finest
// level.
std::array<LatticePoint, 10> nodes_of(const RedGreenLattice& lattice, TetRef leaf, unsigned split_edges) {
  const LatticePoint b = lattice.barycentre(leaf);
  std::array<LatticePoint, 10> nodes;
  const auto vertices = bcc_vertices(b);
  nodes.fill(vertices[0]);
  std::copy(vertices.begin(), vertices.end(), nodes.begin());
  for (int e = 0; e < 6; ++e) {
    if (split_edges >> e & 1) nodes[static_cast<std::size_t>(4 + e)] = bcc_edge_midpoint(b, e);
  }
  for (LatticePoint& node : nodes) {
    for (std::int32_t& c : node) c *= 1 << (lattice.max_level() - leaf.level);
  }
  return nodes;
}

}  // namespace

LeafMesh LeafMesher::mesh(const std::vector<LabelledLeaf>& leaves, Bulk wanted) {
  make_places();
  std::vector<Entry> entries = make_entries(leaves, wanted);
  Tets added;
  const auto add_new = [&](std::size_t i) {
    entries[i].first_new = static_cast<std::uint32_t>(added.size());
    add(leaves[i], added);
  };
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const Entry& entry = entries[i];
    if (entry.bulk) continue;
    if (!entry.known) add_new(i);
    const Place& place = place_of(leaves[i].tet);
    if (!entry.known || place.bulk)
      mark_near(leaves[i], entry.known ? &tets_[place.first_tet] : &added[entry.first_new]);
  }
  want_bulk_near(leaves, entries);
  far_.clear();
  for (std::uint32_t i = 0; i < leaves.size(); ++i) {
    if (!entries[i].wanted) far_.push_back(i);
    if (entries[i].bulk && entries[i].wanted && !entries[i].known) add_new(i);
  }
  LeafMesh result = gather(leaves, entries, added);
  place_vertices(result.mesh.points_mm);
  tets_ = result.mesh.tets;
  return result;
}

std::vector<TetId> LeafMesher::update(const std::vector<LabelledLeaf>& leaves, std::span<const std::uint32_t> touched,
                                      TissueMesh& mesh, std::vector<LeafMesh::Origin>& origins) {
  make_places();
  std::vector<TetId> dropped;
  for (const std::uint32_t i : touched) {
    const LabelledLeaf& leaf = leaves[i];
    Place& place = place_of(leaf.tet);
    if (leaf.gone || place.split_edges != leaf.split_edges) drop(place, dropped);
    if (leaf.gone) continue;
    const bool bulk = is_bulk(leaf);
    if (bulk) {
      if (place.first_tet == kNone) far_.push_back(i);
      continue;
    }
    const bool was_near = place.first_tet != kNone && !place.bulk;
    if (place.first_tet == kNone) append(leaves, i, mesh, origins);
    place.bulk = false;
    if (!was_near) mark_near(leaf, &tets_[place.first_tet]);
  }
  append_bulk_near(leaves, mesh, origins);
  place_vertices(mesh.points_mm);
  std::ranges::sort(dropped);
  return dropped;
}

void LeafMesher::make_places() {
  places_.resize(static_cast<std::size_t>(lattice_.max_level()) + 1);
  for (int level = 0; level <= lattice_.max_level(); ++level)
    places_[static_cast<std::size_t>(level)].resize(lattice_.slot_count(level));
}

bool LeafMesher::is_bulk(const LabelledLeaf& leaf) const {
  return leaf.votes[0].tissue == 0 && !leaf.decided && votes_.hands_label_down(leaf.tet);
}

// Whether it touches something else than bulk background.
bool LeafMesher::is_near(const LabelledLeaf& leaf) const {
  return std::ranges::any_of(nodes_of(lattice_, leaf.tet, leaf.split_edges), [&](const LatticePoint& node) {
    const std::uint32_t v = vertices_.find(node);
    return v < near_.size() && near_[v];
  });
}

std::vector<LeafMesher::Entry> LeafMesher::make_entries(const std::vector<LabelledLeaf>& leaves, Bulk wanted) const {
  std::vector<Entry> entries(leaves.size());
  parallel_for(leaves.size(), [&](std::size_t i) {
    const LabelledLeaf& leaf = leaves[i];
    const Place& place = place_of(leaf.tet);
    Entry& entry = entries[i];
    entry.bulk = is_bulk(leaf);
    entry.known = place.first_tet != kNone && place.split_edges == leaf.split_edges;
    entry.wanted = !entry.bulk || entry.known || wanted == Bulk::all;
  });
  return entries;
}

void LeafMesher::want_bulk_near(const std::vector<LabelledLeaf>& leaves, std::vector<Entry>& entries) const {
  parallel_for(leaves.size(), [&](std::size_t i) {
    if (!entries[i].wanted) entries[i].wanted = is_near(leaves[i]);
  });
}

void LeafMesher::add(const LabelledLeaf& leaf, Tets& added) {
  const auto nodes = nodes_of(lattice_, leaf.tet, leaf.split_edges);
  const bool positive = is_positive(lattice_.barycentre(leaf.tet));
  const GreenSplit& split = leaf.split();
  std::array<VertexId, 10> number;
  number.fill(LatticePointMap::kNone);
  for (std::size_t part = 0; part < static_cast<std::size_t>(split.count); ++part) {
    std::array<VertexId, 4> tet;
    for (std::size_t n = 0; n < 4; ++n) {
      VertexId& v = number[split.tets[part][n]];
      if (v == LatticePointMap::kNone) v = vertices_.insert(nodes[split.tets[part][n]]);
      tet[n] = v;
    }
    if (!positive) std::swap(tet[2], tet[3]);
    added.push_back(tet);
  }
}

void LeafMesher::mark_near(const LabelledLeaf& leaf, const std::array<VertexId, 4>* tets) {
  near_.resize(vertices_.points().size());
  for (int part = 0; part < leaf.split().count; ++part) {
    for (const VertexId v : tets[part]) near_[v] = 1;
  }
}

void LeafMesher::drop(Place& place, std::vector<TetId>& dropped) const {
  if (place.first_tet == kNone) return;
  const auto count = static_cast<TetId>(green_split(place.split_edges).count);
  for (TetId part = 0; part < count; ++part) dropped.push_back(place.first_tet + part);
  place.first_tet = kNone;
}

void LeafMesher::append(const std::vector<LabelledLeaf>& leaves, std::uint32_t at, TissueMesh& mesh,
                        std::vector<LeafMesh::Origin>& origins) {
  const LabelledLeaf& leaf = leaves[at];
  const auto first = static_cast<TetId>(tets_.size());
  add(leaf, tets_);
  mesh.tets.insert(mesh.tets.end(), tets_.begin() + first, tets_.end());
  for (std::uint32_t part = 0; part < static_cast<std::uint32_t>(leaf.split().count); ++part) {
    mesh.tissues.push_back(leaf.votes[part].tissue);
    origins.push_back({at, part});
  }
  place_of(leaf.tet) = {first, leaf.split_edges, is_bulk(leaf)};
}

void LeafMesher::append_bulk_near(const std::vector<LabelledLeaf>& leaves, TissueMesh& mesh,
                                  std::vector<LeafMesh::Origin>& origins) {
  std::vector<char> wanted(far_.size());
  parallel_for(far_.size(), [&](std::size_t n) {
    const LabelledLeaf& leaf = leaves[far_[n]];
    wanted[n] = !leaf.gone && is_bulk(leaf) && is_near(leaf);
  });
  std::size_t kept = 0;
  for (std::size_t n = 0; n < far_.size(); ++n) {
    const LabelledLeaf& leaf = leaves[far_[n]];
    if (leaf.gone || place_of(leaf.tet).first_tet != kNone) continue;
    if (wanted[n]) {
      append(leaves, far_[n], mesh, origins);
    } else {
      far_[kept++] = far_[n];
    }
  }
  far_.resize(kept);
}

// Bulk background last, else in the order of the leaves.
LeafMesh LeafMesher::gather(const std::vector<LabelledLeaf>& leaves, const std::vector<Entry>& entries,
                            const Tets& added) {
  std::vector<std::uint32_t> first(leaves.size());
  std::uint32_t count = 0;
  for (const bool bulk : {false, true}) {
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      if (entries[i].bulk != bulk || !entries[i].wanted) continue;
      first[i] = count;
      count += static_cast<std::uint32_t>(leaves[i].split().count);
    }
  }
  LeafMesh result;
  result.mesh.tets.resize(count);
  result.mesh.tissues.resize(count);
  result.origins.resize(count);
  parallel_for(leaves.size(), [&](std::size_t i) {
    if (!entries[i].wanted) return;
    const LabelledLeaf& leaf = leaves[i];
    Place& place = place_of(leaf.tet);
    const Entry& entry = entries[i];
    for (std::uint32_t part = 0; part < static_cast<std::uint32_t>(leaf.split().count); ++part) {
      const std::uint32_t t = first[i] + part;
      result.mesh.tets[t] = entry.known ? tets_[place.first_tet + part] : added[entry.first_new + part];
      result.mesh.tissues[t] = leaf.votes[part].tissue;
      result.origins[t] = {static_cast<std::uint32_t>(i), part};
    }
    place = {first[i], leaf.split_edges, entry.bulk};
  });
  return result;
}

// Those that have no place yet.
void LeafMesher::place_vertices(std::vector<Vec3>& points_mm) const {
  const std::vector<LatticePoint>& points = vertices_.points();
  const std::size_t first = points_mm.size();
  points_mm.resize(points.size());
  const double fine_unit = std::ldexp(unit_mm_, -lattice_.max_level());
  parallel_for(points.size() - first, [&](std::size_t i) {
    const LatticePoint& p = points[first + i];
    points_mm[first + i] = origin_mm_ + Vec3{fine_unit * p[0], fine_unit * p[1], fine_unit * p[2]};
  });
}

namespace {

// The tetrahedra that touch a tissue, or the others.
TissueMesh part_of(TissueMesh mesh, bool touching) {
  std::vector<char> on_tissue(mesh.points_mm.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    if (mesh.tissues[t] == 0) continue;
    for (const VertexId v : mesh.tets[t]) on_tissue[v] = 1;
  }
  std::size_t kept = 0;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& tet = mesh.tets[t];
    if (std::any_of(tet.begin(), tet.end(), [&](VertexId v) { return on_tissue[v]; }) != touching) continue;
    mesh.tets[kept] = tet;
    mesh.tissues[kept++] = mesh.tissues[t];
  }
  mesh.tets.resize(kept);
  mesh.tissues.resize(kept);
  return with_cushion_last(mesh);
}

}  // namespace

TissueMesh with_cushion_only(TissueMesh mesh) { return part_of(std::move(mesh), true); }

TissueMesh without_cushion(TissueMesh mesh) { return part_of(std::move(mesh), false); }

}  // namespace anatomesh
