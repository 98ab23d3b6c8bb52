// The tetrahedra around one vertex, in numbers of their own.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "mesh/mesh_editor.h"

namespace anatomesh {

/// A copy of the tetrahedra at a vertex of a MeshEditor. Vertices have small numbers here: the centre is 0. Made to be
/// gathered for one vertex after another without allocating.
class VertexStar {
 public:
  using Local = std::uint16_t;
  static constexpr Local kNone = 0xffff;

  struct Tet {
    std::array<Local, 4> corners;
    TissueId tissue;
    bool has(Local v) const { return corners[0] == v || corners[1] == v || corners[2] == v || corners[3] == v; }
  };
  /// A face at the centre. It is on an interface when the tissues of its two tetrahedra differ.
  struct Face {
    Local x, y;                ///< its other corners, x < y
    std::uint16_t tet0, tet1;  ///< positions in tets()
  };

  explicit VertexStar(const MeshEditor& mesh) : mesh_(mesh) {}

  void gather(VertexId centre);

  const std::vector<VertexId>& vertices() const { return vertices_; }
  const std::vector<Vec3>& points() const { return points_; }
  const std::vector<Tet>& tets() const { return tets_; }

  /// Number of a vertex here; kNone when it is not at the centre.
  Local local(VertexId v) const {
    return v < local_.size() && local_[v] < vertices_.size() && vertices_[local_[v]] == v ? local_[v] : kNone;
  }

  /// The faces at the centre, which must not be outer(), by (x, y).
  const std::vector<Face>& gather_faces();

  /// Whether the tetrahedra of each of `count` tissues hang together by the faces last gathered, and there are no
  /// others: then the tissues meet at the centre in the ordinary way.
  bool each_tissue_is_one_piece(int count) const;

 private:
  const MeshEditor& mesh_;
  std::vector<VertexId> vertices_;
  std::vector<Vec3> points_;
  std::vector<Tet> tets_;
  std::vector<Face> faces_;
  std::vector<std::array<std::uint16_t, 3>> sides_;  // x, y, tet
  std::vector<Local> local_;
};

}  // namespace anatomesh
