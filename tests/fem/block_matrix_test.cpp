#include "fem/block_matrix.h"

#include <gtest/gtest.h>

#include <Eigen/SparseCore>
#include <algorithm>

#include "base/parallel.h"
#include "meshes.h"

namespace anatomesh {
namespace {

Eigen::MatrixXd dense(const BlockMatrix& matrix) {
  const auto size = static_cast<Eigen::Index>(3 * matrix.rows());
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(size, size);
  for (std::size_t v = 0; v < matrix.rows(); ++v) {
    for (std::size_t n = matrix.pattern.row_begin[v]; n < matrix.pattern.row_begin[v + 1]; ++n) {
      for (std::size_t k = 0; k < 9; ++k)
        all(static_cast<Eigen::Index>(3 * v + k / 3),
            static_cast<Eigen::Index>(3 * matrix.pattern.columns[n] + k % 3)) = matrix.blocks[n][k];
    }
  }
  return all;
}

TEST(BlockMatrix, ColumnsAreTheNeighboursInAscendingOrder) {
  const testing::ElasticMesh mesh = testing::jittered_box(3, 1);
  const BlockPattern pattern = mesh.stiffness().pattern;
  ASSERT_EQ(pattern.rows(), mesh.points_mm.size());
  for (std::size_t v = 0; v < pattern.rows(); ++v) {
    EXPECT_EQ(pattern.columns[pattern.diagonal[v]], v);
    for (std::size_t n = pattern.row_begin[v] + 1; n < pattern.row_begin[v + 1]; ++n)
      EXPECT_LT(pattern.columns[n - 1], pattern.columns[n]);
  }
  // An inner vertex of this mesh has 14 neighbours.
  EXPECT_EQ(pattern.row_begin[22] - pattern.row_begin[21], 15u);
}

TEST(BlockMatrix, IsTheSumOfItsElements) {
  const testing::ElasticMesh mesh = testing::jittered_box(4, 2);
  const BlockMatrix matrix = mesh.stiffness();
  const Eigen::MatrixXd expected = testing::reference_stiffness(mesh);
  EXPECT_LT((dense(matrix) - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.cwiseAbs().maxCoeff());
  EXPECT_NEAR(mean_diagonal(matrix), expected.diagonal().mean(), 1e-12 * expected.diagonal().mean());
}

TEST(BlockMatrix, IsSymmetricToTheLastBit) {
  const Eigen::MatrixXd all = dense(testing::jittered_box(4, 3).stiffness());
  EXPECT_EQ(all, all.transpose());
}

TEST(BlockMatrix, RigidMotionsNeedNoForce) {
  const testing::ElasticMesh mesh = testing::jittered_box(4, 4);
  const BlockMatrix matrix = mesh.stiffness();
  for (const std::vector<Vec3>& motion : testing::rigid_motions(mesh.points_mm)) {
    std::vector<Vec3> force(motion.size());
    multiply(matrix, motion, force);
    EXPECT_LT(testing::flat(force).norm(), 1e-12 * mean_diagonal(matrix) * testing::flat(motion).norm());
  }
}

TEST(BlockMatrix, ProductIsThatOfTheDenseMatrix) {
  const testing::ElasticMesh mesh = testing::jittered_box(4, 5);
  const BlockMatrix matrix = mesh.stiffness();
  const std::vector<Vec3> x = testing::random_vectors(mesh.points_mm.size(), 6);
  std::vector<Vec3> y(x.size());
  multiply(matrix, x, y);
  const Eigen::VectorXd expected = dense(matrix) * testing::flat(x);
  EXPECT_LT((testing::flat(y) - expected).norm(), 1e-13 * expected.norm());
}

TEST(BlockMatrix, IsFilledAnewWhenThePointsHaveMoved) {
  testing::ElasticMesh mesh = testing::jittered_box(3, 6);
  BlockMatrix matrix = mesh.stiffness();
  for (Vec3& p : mesh.points_mm) p = {1.5 * p.x, p.y, p.z + 0.1 * p.x};
  assemble_stiffness(matrix, mesh.points_mm,
                     {mesh.tets, mesh.tissues, tets_of_vertices(mesh.points_mm.size(), mesh.tets)}, mesh.materials);
  EXPECT_EQ(matrix.blocks, mesh.stiffness().blocks);
}

TEST(BlockMatrix, DoesNotDependOnTheNumberOfThreads) {
  const testing::ElasticMesh mesh = testing::jittered_box(16, 7);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return mesh.stiffness();
  };
  const BlockMatrix one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.blocks, four.blocks);
  EXPECT_EQ(one.pattern.columns, four.pattern.columns);
  EXPECT_EQ(mean_diagonal(one), mean_diagonal(four));
}

// As a mesh with a cushion is registered: what lies behind the tissues' vertices and tetrahedra is not there.
TEST(BlockMatrix, TheFirstPartOfAMeshIsLikeThatPartAlone) {
  const testing::ElasticMesh mesh = testing::jittered_box(3, 9);
  constexpr std::size_t kTets = 60;
  testing::ElasticMesh part = mesh;
  part.tets.resize(kTets);
  part.tissues.resize(kTets);
  VertexId last = 0;
  for (const auto& tet : part.tets) last = std::max(last, std::ranges::max(tet));
  part.points_mm.resize(last + 1);
  const VertexLists<TetId> tets_of_vertex = tets_of_vertices(mesh.points_mm.size(), mesh.tets);
  BlockMatrix first{make_pattern(last + 1, neighbours_of_vertices(tets_of_vertex, mesh.tets)), {}};
  assemble_stiffness(first, part.points_mm, {part.tets, part.tissues, tets_of_vertex}, mesh.materials);
  EXPECT_EQ(dense(first), dense(part.stiffness()));
}

TEST(BlockMatrix, VertexWithoutTetHasAnEmptyDiagonalBlock) {
  testing::ElasticMesh mesh = testing::jittered_box(1, 8);
  mesh.points_mm.push_back({9, 9, 9});
  const BlockMatrix matrix = mesh.stiffness();
  EXPECT_EQ(matrix.blocks[matrix.pattern.diagonal[8]], (std::array<double, 9>{}));
}

}  // namespace
}  // namespace anatomesh
