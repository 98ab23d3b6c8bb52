// Assembly by rows: each row gathers from the tetrahedra around its vertex in ascending order, so that rows can be
// filled in parallel without locks and each sum has a fixed order. Every tetrahedron's shape is computed four times,
// which is cheaper than storing it.
#include "fem/block_matrix.h"

#include <algorithm>

#include "base/parallel.h"
#include "fem/elasticity.h"

namespace anatomesh {
namespace {

constexpr std::size_t kRowsPerBlock = 1024;

}  // namespace

BlockPattern make_pattern(std::size_t vertex_count, const VertexLists<VertexId>& neighbours) {
  BlockPattern pattern;
  pattern.row_begin.assign(vertex_count + 1, 0);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    const auto inside = std::ranges::lower_bound(neighbours[v], vertex_count) - neighbours[v].begin();
    pattern.row_begin[v + 1] = pattern.row_begin[v] + static_cast<std::uint32_t>(inside) + 1;
  }
  pattern.columns.resize(pattern.row_begin.back());
  pattern.diagonal.resize(vertex_count);
  const auto fill_row = [&](std::size_t v) {
    const auto of_row = neighbours[v].first(pattern.row_begin[v + 1] - pattern.row_begin[v] - 1);
    const auto before = std::ranges::lower_bound(of_row, v) - of_row.begin();
    VertexId* const columns = &pattern.columns[pattern.row_begin[v]];
    std::copy_n(of_row.begin(), before, columns);
    columns[before] = static_cast<VertexId>(v);
    std::copy(of_row.begin() + before, of_row.end(), columns + before + 1);
    pattern.diagonal[v] = pattern.row_begin[v] + static_cast<std::uint32_t>(before);
  };
  parallel_for(vertex_count, fill_row, kRowsPerBlock);
  return pattern;
}

void assemble_stiffness(BlockMatrix& matrix, std::span<const Vec3> points_mm, const ElasticTets& elastic,
                        std::span<const Material> materials) {
  const BlockPattern& pattern = matrix.pattern;
  std::vector<Lame> lame(materials.size());
  std::transform(materials.begin(), materials.end(), lame.begin(), lame_of);
  matrix.blocks.resize(pattern.columns.size());
  const auto fill_row = [&](std::size_t v) {
    static thread_local std::vector<std::uint32_t> block_of;  // by vertex, those of the row
    block_of.resize(pattern.rows());
    for (std::size_t n = pattern.row_begin[v]; n < pattern.row_begin[v + 1]; ++n) {
      matrix.blocks[n].fill(0);
      block_of[pattern.columns[n]] = static_cast<std::uint32_t>(n);
    }
    for (const TetId t : elastic.tets_of_vertex[v]) {
      if (t >= elastic.tets.size()) break;
      const auto& tet = elastic.tets[t];
      const TetShape shape = tet_shape({points_mm[tet[0]], points_mm[tet[1]], points_mm[tet[2]], points_mm[tet[3]]});
      const Lame& of_tet = lame[elastic.tissues[t]];
      const auto corner = static_cast<std::size_t>(std::ranges::find(tet, v) - tet.begin());
      for (std::size_t c = 0; c < 4; ++c) {
        const std::array<double, 9> block = stiffness_block(shape.gradients[corner], shape.gradients[c],
                                                            of_tet.lambda * shape.volume, of_tet.mu * shape.volume);
        std::array<double, 9>& sum = matrix.blocks[block_of[tet[c]]];
        for (std::size_t k = 0; k < 9; ++k) sum[k] += block[k];
      }
    }
  };
  parallel_for(pattern.rows(), fill_row, kRowsPerBlock);
}

void multiply(const BlockMatrix& matrix, std::span<const Vec3> x, std::span<Vec3> y) {
  parallel_for(
      matrix.rows(), [&](std::size_t v) { y[v] = multiply_row(matrix, v, x); }, kRowsPerBlock);
}

double mean_diagonal(const BlockMatrix& matrix) {
  const double trace = parallel_sum(matrix.rows(), kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t v = begin; v < end; ++v) {
      const std::array<double, 9>& block = matrix.blocks[matrix.pattern.diagonal[v]];
      sum += block[0] + block[4] + block[8];
    }
    return sum;
  });
  return matrix.rows() == 0 ? 0 : trace / (3 * static_cast<double>(matrix.rows()));
}

}  // namespace anatomesh
