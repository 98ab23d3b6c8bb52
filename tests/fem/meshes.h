// Irregular tetrahedral meshes for tests of the finite elements, and their matrices in Eigen's form.
#pragma once

#include <Eigen/Dense>
#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <vector>

#include "base/vec.h"
#include "fem/block_matrix.h"
#include "fem/elasticity.h"
#include "mesh/cube_mesh.h"

namespace anatomesh::testing {

/// Reals in [-1, 1).
class RandomReals {
 public:
  explicit RandomReals(unsigned seed) : random_(seed) {}
  double next() { return static_cast<double>(random_()) / 2147483648.0 - 1; }
  Vec3 next_vec() {
    const double x = next(), y = next(), z = next();
    return {x, y, z};
  }

 private:
  std::mt19937 random_;
};

/// A mesh with everything a stiffness needs.
struct ElasticMesh {
  std::vector<Vec3> points_mm;
  std::vector<std::array<VertexId, 4>> tets;
  std::vector<std::uint16_t> tissues;
  std::vector<Material> materials = {{3000, 0.45}, {10, 0.1}, {9000, 0.45}, {300000, 0.3}};
  std::vector<std::uint8_t> on_boundary;  ///< one a vertex

  BlockMatrix stiffness() const {
    const VertexLists<TetId> tets_of_vertex = tets_of_vertices(points_mm.size(), tets);
    BlockMatrix matrix{make_pattern(points_mm.size(), neighbours_of_vertices(tets_of_vertex, tets)), {}};
    assemble_stiffness(matrix, points_mm, {tets, tissues, tets_of_vertex}, materials);
    return matrix;
  }
};

/// n x n x n cubes of 2 mm, each cut into six tetrahedra around its diagonal, with every vertex displaced by up to
/// a fifth of an edge and tissues drawn at random.
inline ElasticMesh jittered_box(int n, unsigned seed) {
  RandomReals random(seed);
  const TissueMesh cubes = cube_mesh({n, n, n}, [](int, int, int) { return 0; });
  ElasticMesh mesh;
  mesh.tets = cubes.tets;
  for (const Vec3 p : cubes.points_mm) {
    mesh.points_mm.push_back(2.0 * p + 0.2 * random.next_vec());
    const auto [low, high] = std::minmax({p.x, p.y, p.z});
    mesh.on_boundary.push_back(low == 0 || high == n ? 1 : 0);
  }
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    mesh.tissues.push_back(static_cast<std::uint16_t>((random.next() + 1) * 2));
  return mesh;
}

/// Assembled from element_stiffness(), one element after the other.
inline Eigen::SparseMatrix<double> reference_stiffness(const ElasticMesh& mesh) {
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const auto& tet = mesh.tets[t];
    const auto& p = mesh.points_mm;
    const std::array<double, 144> element =
        element_stiffness({p[tet[0]], p[tet[1]], p[tet[2]], p[tet[3]]}, mesh.materials[mesh.tissues[t]]);
    for (std::size_t r = 0; r < 12; ++r) {
      for (std::size_t c = 0; c < 12; ++c)
        entries.emplace_back(static_cast<int>(3 * tet[r / 3] + r % 3), static_cast<int>(3 * tet[c / 3] + c % 3),
                             element[12 * r + c]);
    }
  }
  const auto size = static_cast<Eigen::Index>(3 * mesh.points_mm.size());
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

inline Eigen::VectorXd flat(const std::vector<Vec3>& vectors) {
  Eigen::VectorXd all(static_cast<Eigen::Index>(3 * vectors.size()));
  for (std::size_t v = 0; v < vectors.size(); ++v) {
    for (std::size_t a = 0; a < 3; ++a) all[static_cast<Eigen::Index>(3 * v + a)] = vectors[v][a];
  }
  return all;
}

inline std::vector<Vec3> random_vectors(std::size_t count, unsigned seed) {
  RandomReals random(seed);
  std::vector<Vec3> vectors(count);
  for (Vec3& v : vectors) v = random.next_vec();
  return vectors;
}

/// The six infinitesimal rigid motions.
inline std::vector<std::vector<Vec3>> rigid_motions(const std::vector<Vec3>& points) {
  std::vector<std::vector<Vec3>> motions;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Vec3 unit;
    unit[axis] = 1;
    motions.emplace_back(points.size(), unit);
    std::vector<Vec3> rotation;
    for (const Vec3 p : points) rotation.push_back(cross(unit, p));
    motions.push_back(rotation);
  }
  return motions;
}

}  // namespace anatomesh::testing
