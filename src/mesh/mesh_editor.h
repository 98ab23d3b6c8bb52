// A mesh under local change: collapses, flips and splits.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// A tetrahedral mesh in which a few neighbouring tetrahedra at a time are replaced by others. Numbers of vertices and
/// tetrahedra stay what they are until result(); places of dead tetrahedra are used again. Changes are those of the
/// caller: nothing here checks that the mesh stays valid. Every change depends on the mesh and the changes before it
/// only. Memory: about 60 bytes a tetrahedron.
class MeshEditor {
 public:
  explicit MeshEditor(TissueMesh mesh);

  /// The mesh as it is now, without what has died, the cushion last.
  TissueMesh result() const;
  /// The living tetrahedra, with the numbers that their vertices have elsewhere: numbers[v]; no points.
  TissueMesh living(std::span<const VertexId> numbers) const;

  std::size_t vertex_count() const { return mesh_.points_mm.size(); }  ///< dead ones included
  std::size_t tet_count() const { return mesh_.tets.size(); }          ///< dead ones included
  std::size_t tissue_tets() const { return tissue_tets_; }             ///< living ones, without the cushion

  Vec3 point(VertexId v) const { return mesh_.points_mm[v]; }
  const std::array<VertexId, 4>& tet(TetId t) const { return mesh_.tets[t]; }
  TissueId tissue(TetId t) const { return mesh_.tissues[t]; }
  bool is_alive(TetId t) const { return mesh_.tets[t][0] != kDead; }

  /// Tetrahedra at v, in no particular order; none: v is dead. Invalid after the next change.
  std::span<const TetId> tets_at(VertexId v) const { return {incident_.data() + stars_[v].begin, stars_[v].count}; }
  /// Number of different tissues at v, the cushion's included; 8: that many or more. It lies on an interface where
  /// there are two, on a junction where there are more. Collapses, flips and splits that keep the tissues' surfaces as
  /// they are, up to where they lie, keep it for all vertices that remain.
  int tissues_at(VertexId v) const { return tissues_at_[v]; }
  /// Whether v lies on a face of one tetrahedron only: the far side of the cushion.
  bool is_outer(VertexId v) const { return is_outer_[v] != 0; }

  /// Number of changes so far.
  std::uint32_t clock() const { return clock_; }
  /// The clock at the last change of a tetrahedron at v; 0: none yet.
  std::uint32_t changed_at(VertexId v) const { return changed_at_[v]; }

  /// Before any change: has the clock show 1, and v changed then.
  void mark(VertexId v);

  void move(VertexId v, Vec3 p);

  /// Merges v into w, which share an edge: the tetrahedra at that edge die, the others at v have w in its place.
  void collapse(VertexId v, VertexId w);

  /// Cuts all tetrahedra at the edge ab in two at a new vertex on it. Returns that vertex.
  VertexId split(VertexId a, VertexId b, Vec3 at);

  /// Replaces tetrahedra by others, all of one tissue.
  void replace(std::span<const TetId> old, std::span<const std::array<VertexId, 4>> fresh, TissueId tissue);

 private:
  static constexpr VertexId kDead = static_cast<VertexId>(-1);

  struct Star {  // a piece of incident_
    std::uint32_t begin = 0, count = 0, capacity = 0;
  };

  std::uint8_t count_tissues(VertexId v) const;
  bool lies_on_bare_face(VertexId v) const;
  VertexId add_vertex(Vec3 p);
  void attach(VertexId v, TetId t);
  void detach(VertexId v, TetId t);
  void kill(TetId t);
  void add(const std::array<VertexId, 4>& tet, TissueId tissue);

  TissueMesh mesh_;
  std::vector<Star> stars_;
  std::vector<TetId> incident_;
  std::vector<TetId> free_;
  std::vector<std::uint8_t> tissues_at_;
  std::vector<std::uint8_t> is_outer_;
  std::vector<std::uint32_t> changed_at_;
  std::uint32_t clock_ = 0;
  std::size_t tissue_tets_ = 0;
};

}  // namespace anatomesh
