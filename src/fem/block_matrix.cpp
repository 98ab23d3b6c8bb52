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

using Tets = std::span<const std::array<VertexId, 4>>;

// Sorts the tetrahedra's corners by vertex (a counting sort: within a vertex they stay in order of tetrahedra).
void find_incidences(std::size_t vertex_count, Tets tets, BlockPattern& pattern) {
  pattern.incident_begin.assign(vertex_count + 1, 0);
  for (const auto& tet : tets) {
    for (const VertexId v : tet) ++pattern.incident_begin[v + 1];
  }
  for (std::size_t v = 0; v < vertex_count; ++v) pattern.incident_begin[v + 1] += pattern.incident_begin[v];
  std::vector<std::uint32_t> next(pattern.incident_begin.begin(), pattern.incident_begin.end() - 1);
  pattern.incidences.resize(4 * tets.size());
  for (std::size_t t = 0; t < tets.size(); ++t) {
    for (std::uint32_t c = 0; c < 4; ++c) pattern.incidences[next[tets[t][c]]++] = {static_cast<TetId>(t), c, {}};
  }
}

// The vertex and its neighbours, ascending.
void columns_of_row(const BlockPattern& pattern, Tets tets, std::size_t v, std::vector<VertexId>& columns) {
  columns.assign(1, static_cast<VertexId>(v));
  for (std::size_t n = pattern.incident_begin[v]; n < pattern.incident_begin[v + 1]; ++n) {
    const auto& tet = tets[pattern.incidences[n].tet];
    columns.insert(columns.end(), tet.begin(), tet.end());
  }
  std::sort(columns.begin(), columns.end());
  columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
}

// Fills columns and row_begin.
void find_columns(std::size_t vertex_count, Tets tets, BlockPattern& pattern) {
  std::vector<std::vector<VertexId>> of_rows((vertex_count + kRowsPerBlock - 1) / kRowsPerBlock);
  pattern.row_begin.assign(vertex_count + 1, 0);
  parallel_blocks(vertex_count, kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    std::vector<VertexId> columns;
    std::vector<VertexId>& all = of_rows[begin / kRowsPerBlock];
    for (std::size_t v = begin; v < end; ++v) {
      columns_of_row(pattern, tets, v, columns);
      pattern.row_begin[v + 1] = static_cast<std::uint32_t>(columns.size());
      all.insert(all.end(), columns.begin(), columns.end());
    }
  });
  for (std::size_t v = 0; v < vertex_count; ++v) pattern.row_begin[v + 1] += pattern.row_begin[v];
  pattern.columns.reserve(pattern.row_begin.back());
  for (const auto& columns : of_rows) pattern.columns.insert(pattern.columns.end(), columns.begin(), columns.end());
}

// Fills diagonal and the blocks of the incidences.
void find_blocks(Tets tets, BlockPattern& pattern) {
  pattern.diagonal.resize(pattern.row_begin.size() - 1);
  parallel_for(
      pattern.diagonal.size(),
      [&](std::size_t v) {
        const auto begin = pattern.columns.begin() + pattern.row_begin[v];
        const auto end = pattern.columns.begin() + pattern.row_begin[v + 1];
        const auto block = [&](VertexId column) {
          return static_cast<std::uint32_t>(std::lower_bound(begin, end, column) - pattern.columns.begin());
        };
        pattern.diagonal[v] = block(static_cast<VertexId>(v));
        for (std::size_t n = pattern.incident_begin[v]; n < pattern.incident_begin[v + 1]; ++n) {
          BlockPattern::Incidence& at = pattern.incidences[n];
          for (std::size_t c = 0; c < 4; ++c) at.blocks[c] = block(tets[at.tet][c]);
        }
      },
      kRowsPerBlock);
}

}  // namespace

BlockPattern make_pattern(std::size_t vertex_count, Tets tets) {
  BlockPattern pattern;
  find_incidences(vertex_count, tets, pattern);
  find_columns(vertex_count, tets, pattern);
  find_blocks(tets, pattern);
  return pattern;
}

void assemble_stiffness(BlockMatrix& matrix, std::span<const Vec3> points_mm, Tets tets,
                        std::span<const std::uint16_t> tissues, std::span<const Material> materials) {
  const BlockPattern& pattern = matrix.pattern;
  std::vector<Lame> lame(materials.size());
  std::transform(materials.begin(), materials.end(), lame.begin(), lame_of);
  matrix.blocks.resize(pattern.columns.size());
  const auto fill_row = [&](std::size_t v) {
    for (std::size_t n = pattern.row_begin[v]; n < pattern.row_begin[v + 1]; ++n) matrix.blocks[n].fill(0);
    for (std::size_t n = pattern.incident_begin[v]; n < pattern.incident_begin[v + 1]; ++n) {
      const BlockPattern::Incidence& at = pattern.incidences[n];
      const auto& tet = tets[at.tet];
      const TetShape shape = tet_shape({points_mm[tet[0]], points_mm[tet[1]], points_mm[tet[2]], points_mm[tet[3]]});
      const Lame& of_tet = lame[tissues[at.tet]];
      for (std::size_t c = 0; c < 4; ++c) {
        const std::array<double, 9> block = stiffness_block(shape.gradients[at.corner], shape.gradients[c],
                                                            of_tet.lambda * shape.volume, of_tet.mu * shape.volume);
        std::array<double, 9>& sum = matrix.blocks[at.blocks[c]];
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
