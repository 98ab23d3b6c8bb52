#include "boundary/matching.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>

#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

Vec3 random_point(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> uniform(0, size);
  const double x = uniform(random), y = uniform(random), z = uniform(random);
  return {x, y, z};
}

std::vector<EdgePoint> random_targets(int count, std::mt19937& random) {
  std::vector<EdgePoint> targets;
  for (int n = 0; n < count; ++n) {
    const TissueId low = static_cast<TissueId>(random() % 3);
    const TissueId high = static_cast<TissueId>(low + 1 + random() % 2);
    targets.push_back({random_point(random, 10), {low, high}, {}});
  }
  return targets;
}

// Source points with two to four tissues; owns the lists that they refer to.
struct Sources {
  std::vector<std::vector<TissueId>> tissues;
  std::vector<SourcePoint> points;

  Sources(int count, std::mt19937& random) : tissues(static_cast<std::size_t>(count)) {
    for (auto& list : tissues) {
      list = {0, 1, 2, 3, 4};
      std::shuffle(list.begin(), list.end(), random);
      list.resize(2 + random() % 3);
      points.push_back({random_point(random, 10), list, 0.3 + 0.1 * static_cast<double>(random() % 20)});
    }
  }
};

// The matches by their definition.
std::vector<Match> brute_force(std::span<const SourcePoint> sources, std::span<const EdgePoint> targets) {
  std::vector<Match> matches;
  for (std::size_t n = 0; n < sources.size(); ++n) {
    const SourcePoint& source = sources[n];
    Vec3 sum;
    int pairs = 0;
    for (std::size_t a = 0; a < source.tissues.size(); ++a) {
      for (std::size_t b = 0; b < source.tissues.size(); ++b) {
        if (source.tissues[a] >= source.tissues[b]) continue;
        const TissuePair pair = {source.tissues[a], source.tissues[b]};
        const EdgePoint* nearest = nullptr;
        for (const EdgePoint& t : targets) {
          const double d = norm(t.position_mm - source.position_mm);
          if (t.pair != pair || d >= source.radius_mm) continue;
          if (!nearest || d < norm(nearest->position_mm - source.position_mm)) nearest = &t;
        }
        if (!nearest) continue;
        sum += nearest->position_mm;
        ++pairs;
      }
    }
    if (pairs > 0) matches.push_back({static_cast<std::uint32_t>(n), (1.0 / pairs) * sum, 0});
  }
  return matches;
}

TEST(Matching, IsThatOfBruteForce) {
  std::mt19937 random(1);
  const std::vector<EdgePoint> targets = random_targets(3000, random);
  const Sources sources(1000, random);
  const std::vector<Match> expected = brute_force(sources.points, targets);
  const std::vector<Match> found = match_points(sources.points, EdgePointIndex(targets));
  ASSERT_EQ(found.size(), expected.size());
  EXPECT_GT(found.size(), 500u);
  EXPECT_LT(found.size(), 1000u);
  for (std::size_t n = 0; n < found.size(); ++n) {
    EXPECT_EQ(found[n].source, expected[n].source);
    EXPECT_LT(norm(found[n].target_mm - expected[n].target_mm), 1e-12);
  }
}

TEST(Matching, ConfidenceFallsFromTheTargetToTheRadius) {
  const std::vector<EdgePoint> targets = {{{1, 0, 0}, {0, 1}, {}}};
  const std::array<TissueId, 2> tissues = {1, 0};  // in any order
  const std::vector<SourcePoint> sources = {
      {{1, 0, 0}, tissues, 2}, {{0, 0, 0}, tissues, 2}, {{1, 2 - 1e-9, 0}, tissues, 2}, {{1, 2, 0}, tissues, 2}};
  const std::vector<Match> found = match_points(sources, EdgePointIndex(targets));
  ASSERT_EQ(found.size(), 3u);
  EXPECT_EQ(found[0].confidence, 1);
  EXPECT_NEAR(found[1].confidence, 0.9375 * 0.9375, 1e-12);
  EXPECT_NEAR(found[2].confidence, 0.5625, 1e-8);
}

TEST(Matching, JunctionGoesToTheMeanOfItsPairs) {
  const std::vector<EdgePoint> targets = {
      {{1, 0, 0}, {0, 1}, {}}, {{0, 1, 0}, {1, 2}, {}}, {{0, 0, 1}, {0, 2}, {}}, {{0, 0, 0}, {0, 3}, {}}};
  const std::array<TissueId, 3> tissues = {0, 1, 2};
  const std::vector<SourcePoint> sources = {{{0, 0, 0}, tissues, 3}};
  const std::vector<Match> found = match_points(sources, EdgePointIndex(targets));
  ASSERT_EQ(found.size(), 1u);
  EXPECT_LT(norm(found[0].target_mm - Vec3{1.0 / 3, 1.0 / 3, 1.0 / 3}), 1e-15);
}

TEST(Matching, OutliersAreTheFarthestForTheirRadius) {
  std::mt19937 random(4);
  const std::vector<EdgePoint> targets = random_targets(500, random);
  const Sources sources(400, random);
  const EdgePointIndex index(targets);
  const std::vector<Match> all = match_points(sources.points, index);
  const std::vector<Match> kept = match_points(sources.points, index, {.outlier_share = 0.25});
  EXPECT_EQ(kept.size(), all.size() - all.size() / 4);
  const auto least_confident = std::min_element(
      kept.begin(), kept.end(), [](const Match& a, const Match& b) { return a.confidence < b.confidence; });
  for (const Match& match : all) {
    const bool is_kept =
        std::any_of(kept.begin(), kept.end(), [&](const Match& k) { return k.source == match.source; });
    EXPECT_EQ(is_kept, match.confidence >= least_confident->confidence);
  }
}

TEST(Matching, DoesNotDependOnTheNumberOfThreads) {
  std::mt19937 random(9);
  const std::vector<EdgePoint> targets = random_targets(5000, random);
  const Sources sources(5000, random);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return match_points(sources.points, EdgePointIndex(targets));
  };
  const std::vector<Match> one = with_threads(1), four = with_threads(4);
  ASSERT_EQ(one.size(), four.size());
  for (std::size_t n = 0; n < one.size(); ++n) {
    EXPECT_EQ(one[n].source, four[n].source);
    EXPECT_EQ(one[n].target_mm, four[n].target_mm);
    EXPECT_EQ(one[n].confidence, four[n].confidence);
  }
}

TEST(Matching, NothingToMatch) {
  const std::array<TissueId, 2> tissues = {0, 1};
  const std::vector<SourcePoint> sources = {{{0, 0, 0}, tissues, 1}};
  EXPECT_TRUE(match_points(sources, EdgePointIndex({})).empty());
  EXPECT_TRUE(match_points({}, EdgePointIndex({})).empty());
}

}  // namespace
}  // namespace anatomesh
