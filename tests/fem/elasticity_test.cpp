#include "fem/elasticity.h"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>

#include "meshes.h"

namespace anatomesh {
namespace {

using Matrix12 = Eigen::Matrix<double, 12, 12, Eigen::RowMajor>;
using Points = std::array<Vec3, 4>;

Points random_tet(testing::RandomReals& random) {
  for (;;) {
    Points p = {random.next_vec(), random.next_vec(), random.next_vec(), random.next_vec()};
    const double volume = tet_shape(p).volume;
    if (volume < 0) std::swap(p[2], p[3]);
    if (std::abs(volume) > 0.1) return p;
  }
}

Matrix12 stiffness(const Points& points, const Material& material) {
  return Eigen::Map<const Matrix12>(element_stiffness(points, material).data());
}

// Elastic energy by way of the strain, not of the stiffness.
double energy(const Points& points, const Material& material, const Points& u) {
  return tet_shape(points).volume * energy_density(element_strain(points, u), material);
}

constexpr std::array<Material, 3> kMaterials = {{{3000, 0.45}, {10, 0.0}, {300000, 0.3}}};

TEST(Elasticity, ShapeGradientsAreThoseOfTheShapeFunctions) {
  testing::RandomReals random(1);
  const Points p = random_tet(random);
  const TetShape shape = tet_shape(p);
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j)
      EXPECT_NEAR(dot(shape.gradients[i], p[j] - p[(i + 1) % 4]), i == j ? 1 : 0, 1e-12);
  }
}

TEST(Elasticity, VolumeOfTheUnitTet) {
  EXPECT_DOUBLE_EQ(tet_shape({Vec3{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}).volume, 1.0 / 6);
}

TEST(Elasticity, LameOfATextbookMaterial) {
  const Lame lame = lame_of({.young_modulus_pa = 1, .poisson_ratio = 0.25});
  EXPECT_DOUBLE_EQ(lame.lambda, 0.4);
  EXPECT_DOUBLE_EQ(lame.mu, 0.4);
}

TEST(Elasticity, StiffnessIsSymmetricAndSemidefiniteWithSixZeros) {
  testing::RandomReals random(2);
  for (const Material& material : kMaterials) {
    for (int n = 0; n < 20; ++n) {
      const Matrix12 k = stiffness(random_tet(random), material);
      EXPECT_EQ(k, k.transpose());
      const Eigen::SelfAdjointEigenSolver<Matrix12> eigen(k);
      const double largest = eigen.eigenvalues()[11];
      for (Eigen::Index e = 0; e < 6; ++e) EXPECT_LT(std::abs(eigen.eigenvalues()[e]), 1e-13 * largest);
      EXPECT_GT(eigen.eigenvalues()[6], 1e-6 * largest);
    }
  }
}

TEST(Elasticity, RigidMotionsNeedNoForce) {
  testing::RandomReals random(3);
  for (const Material& material : kMaterials) {
    const Points p = random_tet(random);
    const Matrix12 k = stiffness(p, material);
    for (const std::vector<Vec3>& motion : testing::rigid_motions({p.begin(), p.end()}))
      EXPECT_LT((k * testing::flat(motion)).norm(), 1e-13 * k.norm());
  }
}

TEST(Elasticity, ForcesAreTheDerivativesOfTheEnergy) {
  testing::RandomReals random(4);
  for (const Material& material : kMaterials) {
    const Points p = random_tet(random);
    Points u = {random.next_vec(), random.next_vec(), random.next_vec(), random.next_vec()};
    const Eigen::VectorXd flat_u = testing::flat({u.begin(), u.end()});
    const Matrix12 k = stiffness(p, material);
    const Eigen::VectorXd force = k * flat_u;
    EXPECT_NEAR(energy(p, material, u), 0.5 * flat_u.dot(force), 1e-12 * k.norm());
    constexpr double kStep = 1e-3;  // the energy is quadratic: central differences are exact
    for (std::size_t n = 0; n < 12; ++n) {
      double& x = u[n / 3][n % 3];
      const double before = x;
      x = before + kStep;
      const double ahead = energy(p, material, u);
      x = before - kStep;
      const double behind = energy(p, material, u);
      x = before;
      EXPECT_NEAR(force[static_cast<Eigen::Index>(n)], (ahead - behind) / (2 * kStep), 1e-9 * k.norm());
    }
  }
}

TEST(Elasticity, StrainOfALinearFieldIsItsSymmetricPart) {
  testing::RandomReals random(5);
  const Points p = random_tet(random);
  const Mat3 slope = {{{0.1, -0.2, 0.3}, {0.05, 0.2, 0}, {-0.1, 0.4, -0.3}}};
  const Mat3 strain = element_strain(p, {slope * p[0], slope * p[1], slope * p[2], slope * p[3]});
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) EXPECT_NEAR(strain[r][c], 0.5 * (slope[r][c] + slope[c][r]), 1e-14);
  }
}

TEST(Elasticity, UniaxialStressNeedsYoungsModulus) {
  // Stretched by e along x and free to thin by nu e across, a body stores E e^2 / 2.
  const Material material{.young_modulus_pa = 5000, .poisson_ratio = 0.4};
  const double e = 0.01;
  const Mat3 strain = {{{e, 0, 0}, {0, -0.4 * e, 0}, {0, 0, -0.4 * e}}};
  EXPECT_NEAR(energy_density(strain, material), 0.5 * 5000 * e * e, 1e-12);
}

}  // namespace
}  // namespace anatomesh
