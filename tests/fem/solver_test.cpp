#include "fem/solver.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCholesky>

#include "base/parallel.h"
#include "meshes.h"

namespace anatomesh {
namespace {

// A mesh, weights on every third vertex and random target displacements.
struct Problem {
  testing::ElasticMesh mesh;
  BlockMatrix stiffness;
  std::vector<double> weight;
  std::vector<Vec3> target;

  Problem(int size, unsigned seed)
      : mesh(testing::jittered_box(size, seed)),
        stiffness(mesh.stiffness()),
        weight(mesh.points_mm.size(), 0),
        target(testing::random_vectors(mesh.points_mm.size(), seed + 1)) {
    const double scale = mean_diagonal(stiffness);
    for (std::size_t v = 0; v < weight.size(); v += 3) weight[v] = scale * static_cast<double>(1 + v % 5);
  }

  std::size_t size() const { return weight.size(); }

  // By a sparse Cholesky factorisation of K + S; fixed vertices get a weight that nothing else comes near.
  Eigen::VectorXd direct_solution() const {
    Eigen::SparseMatrix<double> matrix = testing::reference_stiffness(mesh);
    Eigen::VectorXd load = testing::flat(target);
    for (Eigen::Index n = 0; n < load.size(); ++n) {
      const double w = weight[static_cast<std::size_t>(n / 3)];
      matrix.coeffRef(n, n) += w;
      load[n] *= w;
    }
    return Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(matrix).solve(load);
  }
};

constexpr Mat3 kSlope = {{{0.01, -0.02, 0.03}, {0.005, 0.02, 0}, {-0.01, 0.04, -0.03}}};

TEST(Solver, IsThatOfTheDirectOne) {
  for (unsigned seed = 0; seed < 4; ++seed) {
    const Problem problem(5, seed);
    std::vector<Vec3> u(problem.size());
    const SolveResult result =
        solve_regularized(problem.stiffness, problem.weight, problem.target, u, {.relative_tolerance = 1e-12});
    EXPECT_TRUE(result.converged);
    EXPECT_GT(result.iterations, 10);
    const Eigen::VectorXd expected = problem.direct_solution();
    EXPECT_LT((testing::flat(u) - expected).norm(), 1e-8 * expected.norm());
  }
}

// The patch test: with any materials' mixture of one tissue, a linear field on the boundary is linear inside.
TEST(Solver, LinearFieldOnTheBoundaryIsLinearInside) {
  testing::ElasticMesh mesh = testing::jittered_box(6, 9);
  std::fill(mesh.tissues.begin(), mesh.tissues.end(), std::uint16_t{0});
  const std::size_t count = mesh.points_mm.size();
  std::vector<Vec3> u(count);
  for (std::size_t v = 0; v < count; ++v) {
    if (mesh.on_boundary[v] != 0) u[v] = kSlope * mesh.points_mm[v];
  }
  const std::vector<double> weight(count, 0);
  const std::vector<Vec3> target(count);
  const SolveResult result =
      solve_regularized(mesh.stiffness(), weight, target, u, {.relative_tolerance = 1e-14, .fixed = mesh.on_boundary});
  EXPECT_TRUE(result.converged);
  for (std::size_t v = 0; v < count; ++v) EXPECT_LT(norm(u[v] - kSlope * mesh.points_mm[v]), 1e-10);
  for (const auto& tet : mesh.tets) {
    const auto& p = mesh.points_mm;
    const Mat3 strain =
        element_strain({p[tet[0]], p[tet[1]], p[tet[2]], p[tet[3]]}, {u[tet[0]], u[tet[1]], u[tet[2]], u[tet[3]]});
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(strain[r][c], 0.5 * (kSlope[r][c] + kSlope[c][r]), 1e-10);
    }
  }
}

TEST(Solver, RigidTargetsAreReachedWithoutStrain) {
  Problem problem(4, 12);
  for (std::size_t v = 0; v < problem.size(); ++v)
    problem.target[v] = Vec3{0.3, -0.1, 0.2} + cross(Vec3{0.01, 0.02, -0.03}, problem.mesh.points_mm[v]);
  std::vector<Vec3> u(problem.size());
  EXPECT_TRUE(
      solve_regularized(problem.stiffness, problem.weight, problem.target, u, {.relative_tolerance = 1e-13}).converged);
  for (std::size_t v = 0; v < problem.size(); ++v) EXPECT_LT(norm(u[v] - problem.target[v]), 1e-9);
}

TEST(Solver, FixedVerticesKeepTheirDisplacement) {
  const Problem problem(5, 20);
  std::vector<Vec3> u(problem.size());
  std::vector<std::uint8_t> fixed(problem.size(), 0);
  for (std::size_t v = 0; v < problem.size(); v += 7) {
    fixed[v] = 1;
    u[v] = {0.1, 0.2, static_cast<double>(v)};
  }
  const std::vector<Vec3> before = u;
  EXPECT_TRUE(solve_regularized(problem.stiffness, problem.weight, problem.target, u,
                                {.relative_tolerance = 1e-12, .fixed = fixed})
                  .converged);
  // The forces vanish at the free vertices, and only there.
  std::vector<Vec3> force(problem.size());
  multiply(problem.stiffness, u, force);
  for (std::size_t v = 0; v < problem.size(); ++v) {
    if (fixed[v] != 0) {
      EXPECT_EQ(u[v], before[v]);
      continue;
    }
    EXPECT_LT(norm(force[v] + problem.weight[v] * (u[v] - problem.target[v])), 1e-7 * mean_diagonal(problem.stiffness));
  }
}

TEST(Solver, StartsFromWhatItIsGiven) {
  const Problem problem(4, 30);
  std::vector<Vec3> u(problem.size());
  solve_regularized(problem.stiffness, problem.weight, problem.target, u, {.relative_tolerance = 1e-12});
  const std::vector<Vec3> before = u;
  const SolveResult again =
      solve_regularized(problem.stiffness, problem.weight, problem.target, u, {.relative_tolerance = 1e-10});
  EXPECT_TRUE(again.converged);
  EXPECT_EQ(again.iterations, 0);
  EXPECT_EQ(u, before);
}

TEST(Solver, SaysThatItDidNotConverge) {
  const Problem problem(5, 40);
  std::vector<Vec3> u(problem.size());
  const SolveResult result = solve_regularized(problem.stiffness, problem.weight, problem.target, u,
                                               {.relative_tolerance = 1e-12, .max_iterations = 3});
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 3);
  EXPECT_GT(result.relative_residual, 1e-12);
}

TEST(Solver, StopsWhenCancelled) {
  const Problem problem(4, 41);
  std::vector<Vec3> u(problem.size());
  std::stop_source source;
  source.request_stop();
  const SolveResult result =
      solve_regularized(problem.stiffness, problem.weight, problem.target, u, {.cancel = source.get_token()});
  EXPECT_FALSE(result.converged);
  EXPECT_EQ(result.iterations, 0);
}

TEST(Solver, NothingToDo) {
  const Problem problem(2, 50);
  const std::vector<double> weight(problem.size(), 0);
  std::vector<Vec3> u(problem.size());
  const SolveResult result = solve_regularized(problem.stiffness, weight, problem.target, u);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(u, std::vector<Vec3>(problem.size()));
}

TEST(Solver, DoesNotDependOnTheNumberOfThreads) {
  const Problem problem(14, 60);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    std::vector<Vec3> u(problem.size());
    const SolveResult result = solve_regularized(problem.stiffness, problem.weight, problem.target, u);
    EXPECT_TRUE(result.converged);
    return u;
  };
  const std::vector<Vec3> one = with_threads(1);
  EXPECT_EQ(one, with_threads(2));
  EXPECT_EQ(one, with_threads(5));
}

}  // namespace
}  // namespace anatomesh
