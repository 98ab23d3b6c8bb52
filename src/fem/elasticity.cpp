// The four-node tetrahedron of O. C. Zienkiewicz, R. L. Taylor, "The Finite Element Method", volume 1, 5th edition,
// 2000, chapter 6, in Lamé's form instead of by a 6 x 12 strain matrix. It locks as the Poisson ratio nears 0.5; for
// the registration, where elasticity only carries the boundary's motion inward, that is harmless.
#include "fem/elasticity.h"

namespace anatomesh {

std::array<double, 144> element_stiffness(const std::array<Vec3, 4>& points_mm, const Material& material) {
  const TetShape shape = tet_shape(points_mm);
  const Lame lame = lame_of(material);
  std::array<double, 144> stiffness;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      const std::array<double, 9> block =
          stiffness_block(shape.gradients[i], shape.gradients[j], lame.lambda * shape.volume, lame.mu * shape.volume);
      for (std::size_t n = 0; n < 9; ++n) stiffness[12 * (3 * i + n / 3) + 3 * j + n % 3] = block[n];
    }
  }
  return stiffness;
}

Mat3 element_strain(const std::array<Vec3, 4>& points_mm, const std::array<Vec3, 4>& displacements_mm) {
  const TetShape shape = tet_shape(points_mm);
  Mat3 strain{};
  for (std::size_t n = 0; n < 4; ++n) {
    const Vec3 u = displacements_mm[n], g = shape.gradients[n];
    for (std::size_t r = 0; r < 3; ++r) {
      for (std::size_t c = 0; c < 3; ++c) strain[r][c] += 0.5 * (u[r] * g[c] + u[c] * g[r]);
    }
  }
  return strain;
}

double energy_density(const Mat3& strain, const Material& material) {
  const Lame lame = lame_of(material);
  const double trace = strain[0][0] + strain[1][1] + strain[2][2];
  double squares = 0;
  for (const auto& row : strain) {
    for (const double e : row) squares += e * e;
  }
  return 0.5 * lame.lambda * trace * trace + lame.mu * squares;
}

}  // namespace anatomesh
