// Symmetric sparse matrix of 3x3 blocks: the stiffness of a tetrahedral mesh.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "anatomesh/options.h"
#include "anatomesh/types.h"
#include "mesh/adjacency.h"

namespace anatomesh {

/// Where the blocks are. Depends on the connectivity only. Row v has a block for v and for each vertex that shares an
/// edge with it: about 15 in a tetrahedral mesh.
struct BlockPattern {
  std::vector<std::uint32_t> row_begin;  ///< one a vertex and one more: blocks row_begin[v] .. row_begin[v+1]
  std::vector<VertexId> columns;         ///< one a block, ascending in each row
  std::vector<std::uint32_t> diagonal;   ///< one a vertex: its block (v, v)

  std::size_t rows() const { return diagonal.size(); }
};

/// Pattern of the first `vertex_count` vertices of a mesh, from all its neighbours.
BlockPattern make_pattern(std::size_t vertex_count, const VertexLists<VertexId>& neighbours);

/// All blocks, both triangles, row by row. (Storage in float was measured: no faster on two cores.)
struct BlockMatrix {
  BlockPattern pattern;
  std::vector<std::array<double, 9>> blocks;  ///< row-major

  std::size_t rows() const { return pattern.rows(); }
};

/// The tetrahedra that a stiffness is the sum of: the first ones of a mesh.
struct ElasticTets {
  std::span<const std::array<VertexId, 4>> tets;
  std::span<const std::uint16_t> tissues;    ///< one a tetrahedron
  const VertexLists<TetId>& tets_of_vertex;  ///< of the whole mesh: those from tets.size() on do not count
};

/// Fills the matrix with the stiffness (Pa mm) of a mesh with its pattern. Tetrahedron n is of materials[tissues[n]];
/// none may be flat. The result is symmetric to the last bit and the same for any number of threads. Cost: about 0.2 us
/// a tetrahedron on two cores.
void assemble_stiffness(BlockMatrix& matrix, std::span<const Vec3> points_mm, const ElasticTets& elastic,
                        std::span<const Material> materials);

/// y = matrix * x. Cost: about 3 ns a block on two cores.
void multiply(const BlockMatrix& matrix, std::span<const Vec3> x, std::span<Vec3> y);

/// Mean of all diagonal entries (Pa mm): the scale to which weights of the same unit compare.
double mean_diagonal(const BlockMatrix& matrix);

/// Row v of matrix * x.
inline Vec3 multiply_row(const BlockMatrix& matrix, std::size_t v, std::span<const Vec3> x) {
  Vec3 sum;
  for (std::size_t n = matrix.pattern.row_begin[v]; n < matrix.pattern.row_begin[v + 1]; ++n) {
    const std::array<double, 9>& b = matrix.blocks[n];
    const Vec3 p = x[matrix.pattern.columns[n]];
    sum.x += b[0] * p.x + b[1] * p.y + b[2] * p.z;
    sum.y += b[3] * p.x + b[4] * p.y + b[5] * p.z;
    sum.z += b[6] * p.x + b[7] * p.y + b[8] * p.z;
  }
  return sum;
}

}  // namespace anatomesh
