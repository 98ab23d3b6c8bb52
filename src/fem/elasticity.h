// The linear-elastic tetrahedron with linear displacements.
#pragma once

#include <array>

#include "anatomesh/options.h"
#include "anatomesh/types.h"
#include "base/vec.h"

namespace anatomesh {

/// Lamé's parameters, Pa.
struct Lame {
  double lambda, mu;
};

/// Of a material with a Young's modulus > 0 and a Poisson ratio >= 0 and < 0.5.
inline Lame lame_of(const Material& material) {
  const double e = material.young_modulus_pa, nu = material.poisson_ratio;
  return {e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))};
}

/// Volume and the (constant) gradients of the four shape functions of a tetrahedron.
struct TetShape {
  double volume;                  ///< mm^3; positive for a positively oriented tetrahedron
  std::array<Vec3, 4> gradients;  ///< 1/mm; they add up to 0
};

/// The tetrahedron must not be flat.
inline TetShape tet_shape(const std::array<Vec3, 4>& points_mm) {
  const Vec3 a = points_mm[1] - points_mm[0], b = points_mm[2] - points_mm[0], c = points_mm[3] - points_mm[0];
  const Vec3 bc = cross(b, c), ca = cross(c, a), ab = cross(a, b);
  const double six_volumes = dot(a, bc);
  const double inverse = 1 / six_volumes;
  const Vec3 g1 = inverse * bc, g2 = inverse * ca, g3 = inverse * ab;
  return {six_volumes / 6, {-(g1 + g2 + g3), g1, g2, g3}};
}

/// 3x3 block (i, j) of the stiffness of a tetrahedron with shape gradients gi and gj, row-major:
/// lambda V gi gj^T + mu V (gj gi^T + (gi . gj) I). Block (j, i) is its transpose to the last bit.
inline std::array<double, 9> stiffness_block(Vec3 gi, Vec3 gj, double lambda_volume, double mu_volume) {
  std::array<double, 9> block;
  const double diagonal = mu_volume * dot(gi, gj);
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c)
      block[3 * r + c] = lambda_volume * (gi[r] * gj[c]) + mu_volume * (gi[c] * gj[r]) + (r == c ? diagonal : 0);
  }
  return block;
}

/// 12x12 stiffness, Pa mm, row-major, unknowns x0 y0 z0 x1 ...: symmetric and positive semidefinite; its null space
/// is the six rigid-body motions. The elastic energy is u^T K u / 2 in Pa mm^3.
std::array<double, 144> element_stiffness(const std::array<Vec3, 4>& points_mm, const Material& material);

/// The tetrahedron's constant small strain, from the displacements of its corners (mm).
Mat3 element_strain(const std::array<Vec3, 4>& points_mm, const std::array<Vec3, 4>& displacements_mm);

/// Elastic energy density of a small strain, Pa: lambda tr(e)^2 / 2 + mu e : e.
double energy_density(const Mat3& strain, const Material& material);

}  // namespace anatomesh
