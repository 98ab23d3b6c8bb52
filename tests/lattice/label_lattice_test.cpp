#include "lattice/label_lattice.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "base/parallel.h"
#include "base/vec.h"
#include "lattice/built_lattice.h"
#include "mesh/expect_sound.h"
#include "mesh/mesh_checks.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

using testing::build;
using testing::Corners;
using testing::NamedImage;
using testing::plan_for;

/// The shapes, and anisotropic versions of some.
std::vector<NamedImage> images() {
  std::vector<NamedImage> images = testing::all_shapes();
  images.push_back({"anisotropic_sphere", testing::anisotropic(testing::sphere())});
  images.push_back({"anisotropic_junction", testing::anisotropic(testing::three_label_junction())});
  images.push_back({"anisotropic_noise", testing::anisotropic(testing::noise(2))});
  return images;
}

// Lattice planes that pass through voxel centres (8 voxels) and that do not; large tetrahedra within one tissue.
constexpr std::array<double, 3> kSizes = {8, 5.31, 15.7};

/// Calls check(image, plan, lattice) for every image and some plans.
template <class Check>
void for_each_lattice(const Check& check) {
  for (const NamedImage& named : images()) {
    const TissueImage image = make_tissue_image(named.image);
    for (const double size : kSizes) {
      SCOPED_TRACE(named.name + ", bcc_size_mm " + std::to_string(size));
      const LatticePlan plan = plan_for(image, size, 0.95);
      check(image, plan, build(image, plan));
    }
  }
}

/// Calls visit(offset, depth) for the voxels around a tetrahedron; depth > 0 inside.
template <class Visit>
void for_each_voxel_near(const TissueImage& image, const Corners& corners, const Visit& visit) {
  std::array<int, 3> low{}, high{};
  for (std::size_t a = 0; a < 3; ++a) {
    const auto [least, most] = std::minmax({corners[0][a], corners[1][a], corners[2][a], corners[3][a]});
    const auto index = [&](double x) { return x / image.spacing_mm[a] - static_cast<double>(image.first[a]); };
    low[a] = std::max(0, static_cast<int>(std::ceil(index(least) - 1e-6)));
    high[a] = std::min(image.size[a] - 1, static_cast<int>(std::floor(index(most) + 1e-6)));
  }
  for (int k = low[2]; k <= high[2]; ++k) {
    for (int j = low[1]; j <= high[1]; ++j) {
      for (int i = low[0]; i <= high[0]; ++i)
        visit(image.offset(i, j, k), testing::depth_inside(corners, image.centre_mm(i, j, k)));
    }
  }
}

/// Which tissues the tetrahedra have that a voxel centre lies in or on. Outside the mesh is background.
std::vector<std::set<TissueId>> tissues_at_voxels(const TissueImage& image, const TissueMesh& mesh) {
  std::vector<std::set<TissueId>> found(image.voxels.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const Corners corners = testing::corners_of(mesh.points_mm, mesh.tets[t]);
    for_each_voxel_near(image, corners, [&](std::size_t voxel, double depth) {
      if (depth > -1e-9) found[voxel].insert(mesh.tissues[t]);
    });
  }
  for (auto& tissues : found) {
    if (tissues.empty()) tissues.insert(0);
  }
  return found;
}

// A voxel centre on faces between two tissues may count for either.
TEST(LabelLattice, FidelityIsThatOfTheMesh) {
  for_each_lattice([](const TissueImage& image, const LatticePlan&, const LabelledLattice& lattice) {
    std::vector<Fidelity> least(image.labels.size()), most(image.labels.size());
    const auto tissues = tissues_at_voxels(image, lattice.mesh);
    for (std::size_t v = 0; v < tissues.size(); ++v) {
      for (const TissueId t : tissues[v]) {
        Fidelity& least_of = least[t];
        const bool hit = image.voxels[v] == t;
        ++most[t].in_tets;
        most[t].hits += hit;
        if (tissues[v].size() > 1) continue;
        ++least_of.in_tets;
        least_of.hits += hit;
      }
    }
    ASSERT_EQ(lattice.fidelity.size(), image.labels.size());
    for (std::size_t t = 1; t < most.size(); ++t) {
      SCOPED_TRACE("tissue " + std::to_string(t));
      EXPECT_EQ(lattice.fidelity[t].voxels, image.counts[t]);
      EXPECT_GE(lattice.fidelity[t].in_tets, least[t].in_tets);
      EXPECT_LE(lattice.fidelity[t].in_tets, most[t].in_tets);
      EXPECT_GE(lattice.fidelity[t].hits, least[t].hits);
      EXPECT_LE(lattice.fidelity[t].hits, most[t].hits);
    }
  });
}

/// Tissues with a voxel strictly inside a tetrahedron.
std::set<TissueId> tissues_inside(const TissueImage& image, const Corners& corners) {
  std::set<TissueId> found;
  for_each_voxel_near(image, corners, [&](std::size_t voxel, double depth) {
    if (depth > 1e-9) found.insert(image.voxels[voxel]);
  });
  return found;
}

double longest_edge(const Corners& c) {
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) longest = std::max(longest, norm(c[i] - c[j]));
  }
  return longest;
}

TEST(LabelLattice, FidelityIsReachedUnlessTheSmallestSizeIs) {
  for_each_lattice([](const TissueImage& image, const LatticePlan& plan, const LabelledLattice& lattice) {
    const double smallest = std::ldexp(plan.bcc_size_mm, -plan.levels);
    for (const auto& tet : lattice.mesh.tets) {
      const Corners corners = testing::corners_of(lattice.mesh.points_mm, tet);
      if (longest_edge(corners) < 1.001 * smallest) continue;
      const std::set<TissueId> inside = tissues_inside(image, corners);
      if (inside.size() < 2) continue;
      for (const TissueId t : inside) {
        if (t == 0) continue;
        EXPECT_GE(lattice.fidelity[t].f1(), plan.fidelity[t]);
        EXPECT_GE(lattice.fidelity[t].f2(), plan.fidelity[t]);
      }
    }
  });
}

TEST(LabelLattice, EveryTissueIsPresent) {
  for_each_lattice([](const TissueImage& image, const LatticePlan&, const LabelledLattice& lattice) {
    std::vector<int> tets(image.labels.size(), 0);
    for (const TissueId t : lattice.mesh.tissues) ++tets[t];
    for (std::size_t t = 1; t < tets.size(); ++t) EXPECT_GT(tets[t], 0) << "tissue " << t;
  });
}

TEST(LabelLattice, OneVoxelBetweenLatticePointsIsPresent) {
  for (int at = 0; at < 8; ++at) {
    const LabelImage labels = testing::make_image({16, 16, 16}, [&](int i, int j, int k) {
      const bool chosen = i == 4 + at && j == 4 + (3 * at) % 8 && k == 4 + (5 * at) % 8;
      return static_cast<Label>(chosen ? 2 : 1);
    });
    const TissueImage image = make_tissue_image(labels);
    const LabelledLattice lattice = build(image, plan_for(image, 8, 0.5));
    EXPECT_TRUE(std::count(lattice.mesh.tissues.begin(), lattice.mesh.tissues.end(), 2)) << at;
  }
}

TEST(LabelLattice, IsSoundAndOfGoodShape) {
  for_each_lattice([](const TissueImage&, const LatticePlan&, const LabelledLattice& lattice) {
    const TissueMesh& mesh = lattice.mesh;
    ASSERT_EQ(mesh.tets.size(), mesh.tissues.size());
    testing::expect_sound(mesh.points_mm, mesh.tets);
    const auto worst = testing::worst_shape(mesh.points_mm, mesh.tets);
    testing::expect_within(worst, 30 - 1e-6, 116.57 + 1e-6, 0.58);
  });
}

TEST(LabelLattice, TissuesComeBeforeTheCushion) {
  for_each_lattice([](const TissueImage&, const LatticePlan&, const LabelledLattice& lattice) {
    const TissueMesh& mesh = lattice.mesh;
    const auto cushion = std::find(mesh.tissues.begin(), mesh.tissues.end(), TissueId{0});
    EXPECT_TRUE(std::all_of(cushion, mesh.tissues.end(), [](TissueId t) { return t == 0; }));
    std::set<VertexId> of_tissues;
    for (std::ptrdiff_t t = 0; t < cushion - mesh.tissues.begin(); ++t) {
      const auto& tet = mesh.tets[static_cast<std::size_t>(t)];
      of_tissues.insert(tet.begin(), tet.end());
    }
    ASSERT_FALSE(of_tissues.empty());
    EXPECT_EQ(*of_tissues.rbegin() + 1, of_tissues.size()) << "a vertex of the cushion is among those of the tissues";
  });
}

TEST(LabelLattice, CushionSurroundsTheTissues) {
  for_each_lattice([](const TissueImage&, const LatticePlan&, const LabelledLattice& lattice) {
    std::size_t bare = 0;
    for (const auto& face : testing::all_faces(lattice.mesh.tets))
      bare += face.tets.size() == 1 && lattice.mesh.tissues[face.tets[0]] != 0;
    EXPECT_EQ(bare, 0u);
  });
}

std::size_t tets_of(const LabelledLattice& lattice, TissueId tissue) {
  return static_cast<std::size_t>(std::count(lattice.mesh.tissues.begin(), lattice.mesh.tissues.end(), tissue));
}

/// Corners of the tetrahedra left of x.
std::set<std::vector<double>> tets_left_of(const TissueMesh& mesh, double x) {
  std::set<std::vector<double>> found;
  for (const auto& tet : mesh.tets) {
    std::vector<double> coordinates;
    for (const Vec3 p : testing::corners_of(mesh.points_mm, tet)) {
      if (p.x < x) coordinates.insert(coordinates.end(), {p.x, p.y, p.z});
    }
    if (coordinates.size() == 12) found.insert(coordinates);
  }
  return found;
}

TEST(LabelLattice, FidelityOfOneTissueRefinesThereOnly) {
  const TissueImage image = make_tissue_image(testing::two_touching_cubes());
  LatticePlan plan = plan_for(image, 6, 0.3);
  const LabelledLattice coarse = build(image, plan);
  plan.fidelity[2] = 0.99;
  const LabelledLattice right_finer = build(image, plan);
  plan.fidelity[1] = 0.99;
  const LabelledLattice both_finer = build(image, plan);
  EXPECT_GT(tets_of(right_finer, 2), 2 * tets_of(coarse, 2));
  EXPECT_GT(tets_of(both_finer, 1), tets_of(right_finer, 1));
  EXPECT_EQ(tets_left_of(right_finer.mesh, 5), tets_left_of(coarse.mesh, 5));
  EXPECT_GT(std::min(right_finer.fidelity[2].f1(), right_finer.fidelity[2].f2()),
            std::min(coarse.fidelity[2].f1(), coarse.fidelity[2].f2()));
}

// Without one, a tissue that falls short is refined along its boundary, not all through.
TEST(LabelLattice, ExtraLevelsAreForMissingTissuesOnly) {
  const TissueImage image = make_tissue_image(testing::sphere(12));
  LatticePlan plan = plan_for(image, 8, 1);
  plan.extra_levels = 3;
  const TissueMesh with = build(image, plan).mesh;
  plan.extra_levels = 0;
  const TissueMesh without = build(image, plan).mesh;
  EXPECT_EQ(without.tets.size(), with.tets.size());
  EXPECT_EQ(without.points_mm, with.points_mm);
}

TEST(LabelLattice, HigherFidelityTakesMoreTets) {
  const TissueImage image = make_tissue_image(testing::sphere());
  const auto tets_at = [&](double fidelity) { return build(image, plan_for(image, 16, fidelity)).mesh.tets.size(); };
  EXPECT_LT(tets_at(0.3), tets_at(0.9));
  EXPECT_LE(tets_at(0.9), tets_at(1));
}

TEST(LabelLattice, DoesNotDependOnTheNumberOfThreads) {
  for (const auto& labels : {testing::random_blobs(3), testing::vessel_tree(), testing::noise(1, 12, 40)}) {
    const TissueImage image = make_tissue_image(labels);
    const LatticePlan plan = plan_for(image, 6, 0.95);
    const auto with_threads = [&](int threads) {
      const ThreadLimit limit(threads);
      return build(image, plan).mesh;
    };
    const TissueMesh one = with_threads(1), three = with_threads(3);
    EXPECT_EQ(one.tets, three.tets);
    EXPECT_EQ(one.tissues, three.tissues);
    EXPECT_EQ(one.points_mm, three.points_mm);
  }
}

TEST(LabelLattice, SaysWhenItWouldBeTooLarge) {
  const TissueImage image = make_tissue_image(testing::sphere());
  EXPECT_THROW(build(image, plan_for(image, 1e-4, 0.95)), InvalidInput);
}

TEST(LabelLattice, StopsWhenAskedTo) {
  const TissueImage image = make_tissue_image(testing::sphere());
  std::stop_source source;
  const Progress progress{[&](std::string_view, double fraction) {
                            if (fraction > 0.1) source.request_stop();
                          },
                          source.get_token()};
  const LatticePlan plan = plan_for(image, 8, 0.95);
  EXPECT_THROW(LabelLattice(image, plan).build(Stage(progress, "lattice", 0, 1)), Cancelled);
}

}  // namespace
}  // namespace anatomesh
