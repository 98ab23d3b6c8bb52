// Conjugate gradients, preconditioned by the inverses of the 3x3 diagonal blocks (block Jacobi), for the regularised
// registration of Y. Liu, P. Foteinos, A. Chernikov, N. Chrisochoides, "Mesh deformation-based multi-tissue mesh
// generation for brain images", Engineering with Computers 28(4), 2012. The method is algorithm 9.1 of Y. Saad,
// "Iterative Methods for Sparse Linear Systems", 2nd edition, 2003; the preconditioned residual is not stored but
// computed twice, which is cheaper than its traffic to memory. Symmetric Gauss-Seidel within blocks of rows as the
// preconditioner was measured: half the iterations, each three times as long.
#include "fem/solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

constexpr std::size_t kRowsPerBlock = 1024;

struct Symmetric3 {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;

  Vec3 operator*(Vec3 v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
};

// Inverse by cofactors; zero where the matrix is not positive definite (a vertex that nothing holds stays put).
Symmetric3 inverse(const Symmetric3& m) {
  const double cxx = m.yy * m.zz - m.yz * m.yz, cxy = m.xz * m.yz - m.xy * m.zz, cxz = m.xy * m.yz - m.xz * m.yy;
  const double det = m.xx * cxx + m.xy * cxy + m.xz * cxz;
  if (!(det > 0)) return {};
  const double f = 1 / det;
  return {f * cxx,
          f * cxy,
          f * cxz,
          f * (m.xx * m.zz - m.xz * m.xz),
          f * (m.xy * m.xz - m.xx * m.yz),
          f * (m.xx * m.yy - m.xy * m.xy)};
}

// Two sums in one pass, each added up in the order of the blocks.
template <class Body>
std::array<double, 2> sum_rows(std::size_t rows, const Body& add_row) {
  std::vector<std::array<double, 2>> sums((rows + kRowsPerBlock - 1) / kRowsPerBlock);
  parallel_blocks(rows, kRowsPerBlock, [&](std::size_t begin, std::size_t end) {
    std::array<double, 2> sum = {0, 0};
    for (std::size_t v = begin; v < end; ++v) add_row(v, sum);
    sums[begin / kRowsPerBlock] = sum;
  });
  std::array<double, 2> total = {0, 0};
  for (const auto& sum : sums) total = {total[0] + sum[0], total[1] + sum[1]};
  return total;
}

// K + S over the free vertices.
struct System {
  const BlockMatrix& stiffness;
  std::span<const double> weight;
  std::span<const std::uint8_t> fixed;

  std::size_t rows() const { return stiffness.rows(); }
  bool is_fixed(std::size_t v) const { return !fixed.empty() && fixed[v] != 0; }
  Vec3 multiply_row(std::size_t v, std::span<const Vec3> x) const {
    return anatomesh::multiply_row(stiffness, v, x) + weight[v] * x[v];
  }

  // Zero for fixed vertices, which keeps their search direction and so their displacement unchanged.
  std::vector<Symmetric3> inverse_diagonal() const {
    std::vector<Symmetric3> inverses(rows());
    parallel_for(
        rows(),
        [&](std::size_t v) {
          if (is_fixed(v)) return;
          const std::array<double, 9>& b = stiffness.blocks[stiffness.pattern.diagonal[v]];
          inverses[v] = inverse({b[0] + weight[v], b[1], b[2], b[4] + weight[v], b[5], b[8] + weight[v]});
        },
        kRowsPerBlock);
    return inverses;
  }
};

// Residual S D - (K + S) u of the free vertices; returns the squared norms of S D and of the residual.
std::array<double, 2> start_residual(const System& system, std::span<const Vec3> target, std::span<const Vec3> u,
                                     std::vector<Vec3>& residual) {
  residual.assign(system.rows(), {});
  return sum_rows(system.rows(), [&](std::size_t v, std::array<double, 2>& sum) {
    if (system.is_fixed(v)) return;
    const Vec3 load = system.weight[v] == 0 ? Vec3{} : system.weight[v] * target[v];
    residual[v] = load - system.multiply_row(v, u);
    sum[0] += norm_squared(load);
    sum[1] += norm_squared(residual[v]);
  });
}

}  // namespace

SolveResult solve_regularized(const BlockMatrix& stiffness, std::span<const double> weight,
                              std::span<const Vec3> target_displacement_mm, std::span<Vec3> u,
                              const SolverOptions& options) {
  const System system{stiffness, weight, options.fixed};
  const std::size_t rows = system.rows();
  std::vector<Vec3> residual, image(rows);
  const auto [load_squared, start_squared] = start_residual(system, target_displacement_mm, u, residual);
  const double scale = std::sqrt(std::max(load_squared, start_squared));
  SolveResult result;
  const auto finished = [&](double residual_squared) {
    result.relative_residual = scale > 0 ? std::sqrt(residual_squared) / scale : 0;
    result.converged = result.relative_residual <= options.relative_tolerance;
    return result.converged || result.iterations >= options.max_iterations || options.cancel.stop_requested();
  };
  if (finished(start_squared)) return result;

  const std::vector<Symmetric3> precondition = system.inverse_diagonal();
  std::vector<Vec3> direction(rows);
  double descent = sum_rows(rows, [&](std::size_t v, std::array<double, 2>& sum) {
    direction[v] = precondition[v] * residual[v];
    sum[0] += dot(residual[v], direction[v]);
  })[0];
  for (;;) {
    const double curvature = sum_rows(rows, [&](std::size_t v, std::array<double, 2>& sum) {
      if (system.is_fixed(v)) return;
      image[v] = system.multiply_row(v, direction);
      sum[0] += dot(direction[v], image[v]);
    })[0];
    if (!(curvature > 0)) return result;  // nothing left to gain in floating point
    const double length = descent / curvature;
    const auto [next_descent, residual_squared] = sum_rows(rows, [&](std::size_t v, std::array<double, 2>& sum) {
      u[v] += length * direction[v];
      residual[v] -= length * image[v];
      sum[0] += dot(residual[v], precondition[v] * residual[v]);
      sum[1] += norm_squared(residual[v]);
    });
    ++result.iterations;
    if (finished(residual_squared)) return result;
    const double keep = next_descent / descent;
    descent = next_descent;
    parallel_for(
        rows, [&](std::size_t v) { direction[v] = precondition[v] * residual[v] + keep * direction[v]; },
        kRowsPerBlock);
  }
}

}  // namespace anatomesh
