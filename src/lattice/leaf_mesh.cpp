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
  places_.resize(static_cast<std::size_t>(lattice_.max_level()) + 1);
  for (int level = 0; level <= lattice_.max_level(); ++level)
    places_[static_cast<std::size_t>(level)].resize(lattice_.slot_count(level));
  std::vector<Entry> entries = make_entries(leaves, wanted);
  Tets added;
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (entries[i].bulk) continue;
    if (!entries[i].known) add(leaves[i], entries[i], added);
    if (!entries[i].known || place_of(leaves[i].tet).bulk) mark_near(leaves[i], entries[i], added);
  }
  want_bulk_near(leaves, entries);
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    if (entries[i].bulk && entries[i].wanted && !entries[i].known) add(leaves[i], entries[i], added);
  }
  near_.resize(vertices_.points().size());
  LeafMesh result = gather(leaves, entries, added);
  place_vertices(result);
  tets_ = result.mesh.tets;
  return result;
}

std::vector<LeafMesher::Entry> LeafMesher::make_entries(const std::vector<LabelledLeaf>& leaves, Bulk wanted) const {
  std::vector<Entry> entries(leaves.size());
  parallel_for(leaves.size(), [&](std::size_t i) {
    const LabelledLeaf& leaf = leaves[i];
    const Place& place = place_of(leaf.tet);
    Entry& entry = entries[i];
    entry.bulk = leaf.votes[0].tissue == 0 && !leaf.decided && votes_.hands_label_down(leaf.tet);
    entry.known = place.first_tet != kNone && place.split_edges == leaf.split_edges;
    entry.wanted = !entry.bulk || entry.known || wanted == Bulk::all;
  });
  return entries;
}

// Of the bulk background, what touches something else.
void LeafMesher::want_bulk_near(const std::vector<LabelledLeaf>& leaves, std::vector<Entry>& entries) const {
  const auto is_near = [&](const LatticePoint& node) {
    const std::uint32_t v = vertices_.find(node);
    return v != LatticePointMap::kNone && near_[v];
  };
  parallel_for(leaves.size(), [&](std::size_t i) {
    if (entries[i].wanted) return;
    entries[i].wanted = std::ranges::any_of(nodes_of(lattice_, leaves[i].tet, leaves[i].split_edges), is_near);
  });
}

void LeafMesher::add(const LabelledLeaf& leaf, Entry& entry, Tets& added) {
  const auto nodes = nodes_of(lattice_, leaf.tet, leaf.split_edges);
  const bool positive = is_positive(lattice_.barycentre(leaf.tet));
  const GreenSplit& split = leaf.split();
  entry.first_new = static_cast<std::uint32_t>(added.size());
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

void LeafMesher::mark_near(const LabelledLeaf& leaf, const Entry& entry, const Tets& added) {
  near_.resize(vertices_.points().size());
  const std::array<VertexId, 4>* tets = entry.known ? &tets_[place_of(leaf.tet).first_tet] : &added[entry.first_new];
  for (int part = 0; part < leaf.split().count; ++part) {
    for (const VertexId v : tets[part]) near_[v] = 1;
  }
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
  result.from.resize(count);
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
      result.from[t] = entry.known ? place.first_tet + part : TetComplex::kNone;
    }
    place = {first[i], leaf.split_edges, entry.bulk};
  });
  return result;
}

void LeafMesher::place_vertices(LeafMesh& result) const {
  result.points = vertices_.points();
  result.mesh.points_mm.resize(result.points.size());
  const double fine_unit = std::ldexp(unit_mm_, -lattice_.max_level());
  parallel_for(result.points.size(), [&](std::size_t v) {
    const LatticePoint& p = result.points[v];
    result.mesh.points_mm[v] = origin_mm_ + Vec3{fine_unit * p[0], fine_unit * p[1], fine_unit * p[2]};
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
