#include "image/components.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "base/parallel.h"
#include "support/test_images.h"

namespace anatomesh {
namespace {

/// Number of the component of each voxel, by flooding from voxel to voxel; -1 for background.
std::vector<int> flood(const TissueImage& image) {
  std::vector<int> component(image.voxels.size(), -1);
  const auto nx = static_cast<std::size_t>(image.size[0]), ny = static_cast<std::size_t>(image.size[1]);
  int next = 0;
  for (std::size_t v = 0; v < component.size(); ++v) {
    if (image.voxels[v] == 0 || component[v] >= 0) continue;
    std::vector<std::size_t> stack = {v};
    component[v] = next;
    while (!stack.empty()) {
      const std::size_t at = stack.back();
      stack.pop_back();
      const int i = static_cast<int>(at % nx), j = static_cast<int>(at / nx % ny), k = static_cast<int>(at / nx / ny);
      for (int n = 0; n < 27; ++n) {
        const int x = i + n % 3 - 1, y = j + n / 3 % 3 - 1, z = k + n / 9 - 1;
        if (!image.contains(x, y, z) || image.at(x, y, z) != image.voxels[v]) continue;
        const std::size_t to = image.offset(x, y, z);
        if (component[to] >= 0) continue;
        component[to] = next;
        stack.push_back(to);
      }
    }
    ++next;
  }
  return component;
}

void expect_as_flooded(const TissueImage& image) {
  const ImageComponents components(image);
  const std::vector<int> expected = flood(image);
  std::map<int, std::uint64_t> voxels;
  for (std::uint32_t v = 0; v < expected.size(); ++v) {
    if (expected[v] < 0) continue;
    ASSERT_EQ(components.of(v), static_cast<std::uint32_t>(expected[v])) << v;
    ++voxels[expected[v]];
  }
  ASSERT_EQ(components.list().size(), voxels.size());
  std::vector<std::uint32_t> counts(image.labels.size(), 0);
  for (std::uint32_t c = 0; c < voxels.size(); ++c) {
    const ImageComponent& component = components.list()[c];
    EXPECT_EQ(component.voxels, voxels[static_cast<int>(c)]);
    EXPECT_EQ(component.tissue, image.voxels[component.first_voxel]);
    EXPECT_EQ(expected[component.first_voxel], static_cast<int>(c));
    ++counts[component.tissue];
  }
  EXPECT_EQ(components.count_by_tissue(counts.size()), counts);
}

TEST(ImageComponents, AreThoseOfAFlood) {
  for (const auto& [name, image] : testing::all_test_images()) {
    SCOPED_TRACE(name);
    expect_as_flooded(make_tissue_image(image));
  }
}

TEST(ImageComponents, AreThoseOfAFloodInNoise) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(seed);
    const int labels = 1 + static_cast<int>(seed % 7);
    expect_as_flooded(make_tissue_image(testing::noise(seed, 5 + static_cast<int>(seed), labels)));
  }
}

TEST(ImageComponents, VoxelsThatTouchAtACornerAreOne) {
  const auto two = [](int di, int dj, int dk) {
    return ImageComponents(make_tissue_image(testing::make_image({8, 8, 8},
                                                                 [&](int i, int j, int k) {
                                                                   return Label(
                                                                       (i == 3 && j == 3 && k == 3) ||
                                                                       (i == 3 + di && j == 3 + dj && k == 3 + dk));
                                                                 })))
        .list()
        .size();
  };
  EXPECT_EQ(two(1, 0, 0), 1u);
  EXPECT_EQ(two(1, 1, 0), 1u);
  EXPECT_EQ(two(-1, 1, 1), 1u);
  EXPECT_EQ(two(2, 0, 0), 2u);
  EXPECT_EQ(two(1, 2, 1), 2u);
}

TEST(ImageComponents, DoNotDependOnTheNumberOfThreads) {
  const TissueImage image = make_tissue_image(testing::noise(5, 24, 2));
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    const ImageComponents components(image);
    std::vector<std::uint32_t> of;
    for (std::uint32_t v = 0; v < image.voxels.size(); ++v) {
      if (image.voxels[v] != 0) of.push_back(components.of(v));
    }
    return of;
  };
  EXPECT_EQ(with_threads(1), with_threads(3));
}

std::uint64_t smallest_island(const TissueImage& image) {
  const ImageComponents components(image);
  std::map<TissueId, std::vector<std::uint64_t>> sizes;
  for (const ImageComponent& c : components.list()) sizes[c.tissue].push_back(c.voxels);
  std::uint64_t least = ~std::uint64_t{0};
  for (auto& [tissue, list] : sizes) {
    std::sort(list.begin(), list.end());
    if (list.size() > 1) least = std::min(least, list.front());
  }
  return least;
}

TEST(DropIslands, LeavesNoneBelowTheSize) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE(seed);
    TissueImage image = make_tissue_image(testing::noise(seed, 10, 9));
    const TissueImage before = image;
    const auto dropped = drop_islands(image, 5);
    std::uint64_t changed = 0, listed = 0;
    for (std::size_t v = 0; v < image.voxels.size(); ++v) changed += image.voxels[v] != before.voxels[v];
    for (const DroppedIsland& island : dropped) {
      EXPECT_LT(island.voxels, 5u);
      listed += island.voxels;
    }
    EXPECT_GT(changed, 0u);
    EXPECT_LE(changed, listed);
    EXPECT_GE(smallest_island(image), smallest_island(before));
    for (std::size_t t = 0; t < image.labels.size(); ++t) {
      EXPECT_EQ(image.counts[t], static_cast<std::uint64_t>(
                                     std::count(image.voxels.begin(), image.voxels.end(), static_cast<TissueId>(t))));
      EXPECT_GT(image.counts[t], 0u);
    }
  }
}

TEST(DropIslands, TakeWhatSurroundsThem) {
  const LabelImage labels = testing::make_image({14, 14, 14}, [](int i, int j, int k) {
    if (i == 3 && j == 3 && k == 3) return Label(5);   // inside 1
    if (i == 12 && j == 7 && k == 7) return Label(5);  // in the background
    if (i > 5 && i < 9 && j > 5 && j < 9 && k > 5 && k < 9) return Label(5);
    return Label(i < 10 && i > 0 && j > 0 && k > 0 && j < 13 && k < 13 ? 1 : 0);
  });
  TissueImage image = make_tissue_image(labels);
  const auto dropped = drop_islands(image, 2);
  ASSERT_EQ(dropped.size(), 2u);
  const auto at = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return image.labels[image.at(static_cast<int>(i - image.first[0]), static_cast<int>(j - image.first[1]),
                                 static_cast<int>(k - image.first[2]))];
  };
  EXPECT_EQ(at(3, 3, 3), 1u);
  EXPECT_EQ(at(12, 7, 7), 0u);
  EXPECT_EQ(at(7, 7, 7), 5u);
}

TEST(DropIslands, TheLargestComponentStays) {
  TissueImage image = make_tissue_image(testing::one_voxel());
  EXPECT_TRUE(drop_islands(image, 1000).empty());
  EXPECT_EQ(image.counts[1], 1u);
}

TEST(DropIslands, NothingBelowTwo) {
  TissueImage image = make_tissue_image(testing::noise(1));
  const auto before = image.voxels;
  EXPECT_TRUE(drop_islands(image, 0).empty());
  EXPECT_TRUE(drop_islands(image, 1).empty());
  EXPECT_EQ(image.voxels, before);
}

}  // namespace
}  // namespace anatomesh
