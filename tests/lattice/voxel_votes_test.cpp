#include "lattice/voxel_votes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "base/vec.h"
#include "lattice/lattice_mesh.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

using testing::Corners;
using testing::leaves_of;

/// An image under a lattice that covers its crop, refined at random.
class VotedImage {
 public:
  VotedImage(const LabelImage& image, double unit_mm, Vec3 offset_mm, unsigned seed)
      : image_(make_tissue_image(image)),
        unit_mm_(unit_mm),
        origin_mm_(origin_of(image_, unit_mm) + offset_mm),
        lattice_(cells_over(image_, unit_mm), 3),
        votes_(image_, lattice_, origin_mm_, unit_mm) {
    std::mt19937 random(seed);
    for (int round = 0; round < 3; ++round) {
      std::vector<TetRef> marked;
      for (const TetRef t : leaves_of(lattice_)) {
        if (t.level < 3 && random() % 40 == 0) marked.push_back(t);
      }
      votes_.descend(lattice_.refine(marked));
    }
  }

  const TissueImage& image() const { return image_; }
  const RedGreenLattice& lattice() const { return lattice_; }
  const VoxelVotes& votes() const { return votes_; }

  /// Centre of a voxel in units of a level.
  Vec3 position(std::uint32_t voxel, int level) const {
    const auto nx = static_cast<std::uint32_t>(image_.size[0]), ny = static_cast<std::uint32_t>(image_.size[1]);
    const Vec3 centre = image_.centre_mm(static_cast<int>(voxel % nx), static_cast<int>(voxel / nx % ny),
                                         static_cast<int>(voxel / nx / ny));
    return (std::ldexp(1.0, level) / unit_mm_) * (centre - origin_mm_);
  }

  /// Corners of a leaf, or of one of its green parts, in units of its level.
  Corners corners_of(TetRef leaf, std::size_t part) const {
    const LatticePoint b = lattice_.barycentre(leaf);
    const auto vertices = bcc_vertices(b);
    Corners corners;
    for (std::size_t n = 0; n < 4; ++n) {
      const int node = green_split(lattice_.split_edges(leaf)).tets[part][n];
      const LatticePoint p = node < 4 ? vertices[static_cast<std::size_t>(node)] : bcc_edge_midpoint(b, node - 4);
      for (std::size_t a = 0; a < 3; ++a) corners[n][a] = p[a];
    }
    return corners;
  }

  std::size_t parts(TetRef leaf) const {
    return static_cast<std::size_t>(green_split(lattice_.split_edges(leaf)).count);
  }

 private:
  static std::array<std::int32_t, 3> cells_over(const TissueImage& image, double unit_mm) {
    std::array<std::int32_t, 3> cells{};
    for (std::size_t a = 0; a < 3; ++a)
      cells[a] = static_cast<std::int32_t>(std::ceil(image.size[a] * image.spacing_mm[a] / (4 * unit_mm))) + 3;
    return cells;
  }
  static Vec3 origin_of(const TissueImage& image, double unit_mm) {
    return image.centre_mm(0, 0, 0) - 4 * unit_mm * Vec3{1, 1, 1};
  }

  TissueImage image_;
  double unit_mm_;
  Vec3 origin_mm_;
  RedGreenLattice lattice_;
  VoxelVotes votes_;
};

/// Lattice planes through voxel centres (first), and anywhere else. Too fine for tetrahedra to be large and pure.
const std::vector<VotedImage>& voted_images() {
  static const std::vector<VotedImage> images = [] {
    std::vector<VotedImage> made;
    made.reserve(5);  // what a vote refers to must stay in its place
    made.emplace_back(testing::noise(1, 4), 1, Vec3{}, 1);
    made.emplace_back(testing::noise(2, 6), 1.5, Vec3{}, 2);
    made.emplace_back(testing::noise(3, 2), 0.7, Vec3{}, 3);
    made.emplace_back(testing::noise(4, 5), 1.37, Vec3{-0.31, -0.77, -0.113}, 4);
    made.emplace_back(testing::anisotropic(testing::noise(5, 5)), 1.7, Vec3{-0.2, 0, -0.5}, 5);
    return made;
  }();
  return images;
}

TEST(VoxelVotes, EachVoxelIsInExactlyOneTet) {
  for (const VotedImage& voted : voted_images()) {
    std::vector<int> holders(voted.image().voxels.size(), 0);
    for (const TetRef leaf : leaves_of(voted.lattice())) {
      EXPECT_EQ(voted.votes().vote(leaf).count, voted.votes().voxels(leaf).size());
      for (const std::uint32_t v : voted.votes().voxels(leaf)) ++holders[v];
    }
    EXPECT_EQ(std::count(holders.begin(), holders.end(), 1), std::ssize(holders));
  }
}

TEST(VoxelVotes, HoldersAreFound) {
  for (const VotedImage& voted : voted_images()) {
    for (const TetRef leaf : leaves_of(voted.lattice())) {
      for (std::size_t part = 0; part < voted.parts(leaf); ++part) {
        for (const std::uint32_t v : voted.votes().voxels_of_part(leaf, part)) {
          const auto holder = voted.votes().holder_of(v);
          ASSERT_TRUE(holder.has_value());
          EXPECT_EQ(holder->leaf, leaf);
          EXPECT_EQ(holder->part, static_cast<int>(part));
        }
      }
    }
  }
}

TEST(VoxelVotes, VoxelsLieInTheirTets) {
  for (const VotedImage& voted : voted_images()) {
    for (const TetRef leaf : leaves_of(voted.lattice())) {
      for (const std::uint32_t v : voted.votes().voxels(leaf)) {
        const LatticePoint b = voted.lattice().barycentre(leaf);
        const auto share = bcc_barycentric_times_4(b, voted.position(v, leaf.level));
        EXPECT_GE(*std::min_element(share.begin(), share.end()), -1e-9);
      }
    }
  }
}

TEST(VoxelVotes, GreenPartsShareTheVoxelsOfTheirLeaf) {
  for (const VotedImage& voted : voted_images()) {
    for (const TetRef leaf : leaves_of(voted.lattice())) {
      if (voted.lattice().split_edges(leaf) == 0) continue;
      const auto votes = voted.votes().green_votes(leaf);
      std::uint32_t total = 0;
      for (std::size_t c = 0; c < voted.parts(leaf); ++c) total += votes[c].count;
      EXPECT_EQ(total, voted.votes().vote(leaf).count);
    }
  }
}

TEST(VoxelVotes, GreenPartsHoldWhatLiesInThem) {
  for (const VotedImage& voted : voted_images()) {
    for (const TetRef leaf : leaves_of(voted.lattice())) {
      for (std::size_t c = 0; c < voted.parts(leaf); ++c) {
        std::map<TissueId, std::uint32_t> inside, touching;
        for (const std::uint32_t v : voted.votes().voxels(leaf)) {
          const double depth = testing::depth_inside(voted.corners_of(leaf, c), voted.position(v, leaf.level));
          inside[voted.image().voxels[v]] += depth > 1e-9;
          touching[voted.image().voxels[v]] += depth > -1e-9;
        }
        for (const auto& [tissue, most] : touching) {
          EXPECT_GE(voted.votes().voxels_of(leaf, c, tissue), inside[tissue]);
          EXPECT_LE(voted.votes().voxels_of(leaf, c, tissue), most);
        }
      }
    }
  }
}

TEST(VoxelVotes, CountsTheVoxelsOfTheTissueItTakes) {
  for (const VotedImage& voted : voted_images()) {
    for (const TetRef leaf : leaves_of(voted.lattice())) {
      const Vote& vote = voted.votes().vote(leaf);
      std::map<TissueId, std::uint32_t> counts;
      for (const std::uint32_t v : voted.votes().voxels(leaf)) ++counts[voted.image().voxels[v]];
      EXPECT_EQ(vote.hits, counts[vote.tissue]);
      EXPECT_EQ(vote.pure, vote.hits == vote.count);
      if (vote.count < VoxelVotes::kQuorum) continue;
      for (const auto& [tissue, count] : counts) EXPECT_GE(vote.hits, count);
    }
  }
}

TEST(VoxelVotes, NoVoxelIsLostInsideLargePureTets) {
  for (const double unit_mm : {2.0, 3.1, 5.0}) {
    const VotedImage voted(testing::no_background_box(), unit_mm, {}, 9);
    const RedGreenLattice& lattice = voted.lattice();
    std::uint64_t total = 0;
    for (const TetRef leaf : leaves_of(lattice)) total += voted.votes().vote(leaf).count;
    for (int level = 0; level < lattice.max_level(); ++level) {
      for (const TetRef t : lattice.tets_of_level(level)) {
        if (lattice.is_refined(t) && voted.votes().hands_label_down(t)) total += voted.votes().vote(t).count;
      }
    }
    EXPECT_EQ(total, voted.image().voxels.size());
  }
}

TEST(VoxelVotes, TetsInOneTissueTakeIt) {
  const VotedImage voted(testing::sphere(3), 1, {}, 9);
  const auto leaves = leaves_of(voted.lattice());
  for (std::size_t n = 0; n < leaves.size(); n += 7) {
    const TetRef leaf = leaves[n];
    // All voxels around the tetrahedron, at most two and a half away from it, decide.
    const Vec3 b = {static_cast<double>(voted.lattice().barycentre(leaf)[0]),
                    static_cast<double>(voted.lattice().barycentre(leaf)[1]),
                    static_cast<double>(voted.lattice().barycentre(leaf)[2])};
    const double reach = 4.5 * std::ldexp(1.0, leaf.level);
    std::map<TissueId, int> near;
    for (std::uint32_t v = 0; v < voted.image().voxels.size(); ++v) {
      const Vec3 d = voted.position(v, leaf.level) - b;
      if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) < reach) ++near[voted.image().voxels[v]];
    }
    if (near.size() == 1) {
      EXPECT_EQ(voted.votes().vote(leaf).tissue, near.begin()->first);
    }
  }
}

}  // namespace
}  // namespace anatomesh
