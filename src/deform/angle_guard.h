// The angle guard: no vertex moves where one of its tetrahedra would leave the bounds. Since the lattice starts
// inside them, they hold at every moment and so for the final mesh.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "base/stage.h"
#include "mesh/adjacency.h"
#include "mesh/star_slack.h"
#include "mesh/tet_shape.h"
#include "mesh/tissue_mesh.h"

namespace anatomesh {

/// Moves vertices of a mesh under bounds on the shape of every tetrahedron. Tetrahedra of the cushion need only
/// stay positive with a little to spare.
class AngleGuard {
 public:
  /// fixed: by vertex, whether it stays where it is; empty: none does. Must outlive the guard.
  AngleGuard(TissueMesh& mesh, const MeshTopology& topology, const ShapeBounds& bounds,
             std::span<const char> fixed = {})
      : mesh_(mesh), topology_(topology), bounds_(bounds), fixed_(fixed) {}

  /// Moves v towards p as far as it goes: all the way, or 1/2, 1/4, ... of it, `halvings` times. Returns
  /// the share gone, 0 if none. Neighbours of v must not move at the same time.
  double advance(VertexId v, Vec3 p, int halvings) const;

  /// Moves v towards the goal like advance() and then, where it was stopped or one of its tetrahedra came near its
  /// bounds, to the best place around: the least (x - goal)^T metric (x - goal), in units of an edge, and slack. Found
  /// in steps of `reach` (mm; a fifth of an edge) and fractions of it; the metric's larger eigenvalues are about 1.
  /// Returns what advance() does. Neighbours of v must not move at the same time.
  double advance_best(VertexId v, Vec3 goal, const Mat3& metric, double reach) const;

  /// Moves v to `mean`, or 0.3 of the way, where that does not make the worst of its tetrahedra worse.
  void make_even(VertexId v, Vec3 mean) const;

 private:
  const StarSlack& star(VertexId v) const;
  double advance(const StarSlack& star, VertexId v, Vec3 p, int halvings) const;
  bool is_fixed(VertexId v) const { return !fixed_.empty() && fixed_[v]; }

  TissueMesh& mesh_;
  const MeshTopology& topology_;
  ShapeBounds bounds_;
  std::span<const char> fixed_;
};

/// Calls visit(v) for every vertex, for the runs of one colour in parallel: visit may move v and read its neighbours.
/// Throws Cancelled between two colours.
void for_each_vertex_by_colour(const MeshTopology& topology, const Stage& stage,
                               const std::function<void(VertexId)>& visit);

/// Moves all vertices towards their goals, the runs of one colour in parallel, up to `sweeps` times.
/// Vertices without a goal keep goal == position. The result does not depend on the number of threads.
void advance_all(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, std::span<const Vec3> goals,
                 int sweeps, const Stage& stage);

/// Moves the vertices inside the tissues towards the mean of their neighbours where that does not make the worst of
/// their tetrahedra worse: makes room for the interfaces.
void relax_interior(TissueMesh& mesh, const MeshTopology& topology, const AngleGuard& guard, const Stage& stage);

}  // namespace anatomesh
