// The displacements that weigh elastic energy against distance to the targets.
#pragma once

#include <cstdint>
#include <span>
#include <stop_token>

#include "anatomesh/types.h"
#include "fem/block_matrix.h"

namespace anatomesh {

/// When solve_regularized() stops, and which vertices stand still.
struct SolverOptions {
  double relative_tolerance = 1e-6;          ///< > 0; of the residual's norm
  int max_iterations = 1000;                 ///< >= 0
  std::span<const std::uint8_t> fixed = {};  ///< one a vertex, not 0: keeps the displacement it comes with; empty: none
  std::stop_token cancel = {};               ///< ends the iterations early; the result is then not converged
};

/// What solve_regularized() reached.
struct SolveResult {
  int iterations = 0;
  double relative_residual = 0;  ///< norm of (K + S) u - S D over free vertices, relative to what it is compared with
  bool converged = false;        ///< relative_residual <= relative_tolerance
};

/// Minimises u^T K u + (u - D)^T S (u - D) over the displacements u (mm) of the vertices that are not fixed, that is,
/// solves (K + S) u = S D. S is the diagonal matrix of `weight` (>= 0, unit of K; 0: no target), D is
/// `target_displacement_mm` (read only where the weight is not 0). u holds the start and receives the result.
/// The residual is compared with the larger of the norms of S D and of the residual at the start. Never throws for
/// lack of convergence. The same bits for any number of threads. Cost of an iteration: memory-bound, about 4 ns a
/// block on two cores.
SolveResult solve_regularized(const BlockMatrix& stiffness, std::span<const double> weight,
                              std::span<const Vec3> target_displacement_mm, std::span<Vec3> u,
                              const SolverOptions& options = {});

}  // namespace anatomesh
