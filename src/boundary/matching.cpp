// Correspondence of mesh and image boundary, after Y. Liu, P. Foteinos, A. Chernikov, N. Chrisochoides, "Mesh
// deformation-based multi-tissue mesh generation for brain images", Engineering with Computers 28(4), 2012: each
// source point goes to its closest target point. Departures: a target must be of the same two tissues, so that
// neighbouring surfaces do not attract each other's vertices; where three or more tissues meet, the mean of the
// closest targets of all pairs stands for the point where those surfaces meet; the trimming of outliers of the
// underlying registration (O. Clatz et al., "Robust nonrigid registration to capture brain shift from intraoperative
// MRI", IEEE Transactions on Medical Imaging 24(11), 2005) is an option, since labels leave few of them.
#include "boundary/matching.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <nanoflann.hpp>

#include "base/parallel.h"
#include "base/vec.h"

namespace anatomesh {
namespace {

// Points as nanoflann wants to see them.
struct PointCloud {
  std::vector<Vec3> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t n, std::size_t axis) const { return points[n][axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

using Tree =
    nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointCloud>, PointCloud, 3, std::uint32_t>;

struct PairTree {
  PointCloud cloud;
  std::unique_ptr<Tree> tree;
};

// The nearest point within the radius; the search starts with that sphere instead of the whole space.
struct NearestWithin {
  using DistanceType = double;

  double squared;
  std::uint32_t index = 0;
  bool any = false;

  bool full() const { return true; }
  double worstDist() const { return squared; }
  bool addPoint(double distance_squared, std::uint32_t point) {
    if (!(distance_squared < squared)) return true;  // nanoflann asks for worstDist() once a leaf only
    squared = distance_squared;
    index = point;
    any = true;
    return true;
  }
};

// A match and how far it is, as a share of its radius.
struct Candidate {
  Match match;
  double reach = -1;  // < 0: no target found
};

Candidate match_one(const SourcePoint& source, const EdgePointIndex& targets) {
  Candidate found;
  Vec3 sum;
  int count = 0;
  for (std::size_t a = 0; a < source.tissues.size(); ++a) {
    for (std::size_t b = a + 1; b < source.tissues.size(); ++b) {
      const auto [low, high] = std::minmax(source.tissues[a], source.tissues[b]);
      Vec3 target;
      if (!targets.nearest(source.position_mm, {low, high}, source.radius_mm, target)) continue;
      sum += target;
      ++count;
    }
  }
  if (count == 0) return found;
  found.match.target_mm = (1.0 / count) * sum;
  found.reach = norm(found.match.target_mm - source.position_mm) / source.radius_mm;
  const double share = 1 - 0.25 * found.reach * found.reach;
  found.match.confidence = share * share;
  return found;
}

void drop_farthest(std::vector<Candidate>& matches, double share) {
  const std::size_t dropped = static_cast<std::size_t>(share * static_cast<double>(matches.size()));
  if (dropped == 0) return;
  std::vector<double> reach(matches.size());
  for (std::size_t n = 0; n < matches.size(); ++n) reach[n] = matches[n].reach;
  const auto limit = reach.end() - static_cast<std::ptrdiff_t>(dropped);
  std::nth_element(reach.begin(), limit, reach.end());
  std::erase_if(matches, [worst = *limit](const Candidate& c) { return c.reach >= worst; });
}

}  // namespace

struct EdgePointIndex::Trees {
  std::map<TissuePair, PairTree> by_pair;
};

EdgePointIndex::EdgePointIndex(std::span<const EdgePoint> points) : trees_(std::make_unique<Trees>()) {
  for (const EdgePoint& p : points) trees_->by_pair[p.pair].cloud.points.push_back(p.position_mm);
  std::vector<PairTree*> all;
  for (auto& [pair, tree] : trees_->by_pair) all.push_back(&tree);
  constexpr std::size_t kPointsPerLeaf = 12;
  parallel_for(
      all.size(), [&](std::size_t n) { all[n]->tree = std::make_unique<Tree>(3, all[n]->cloud, kPointsPerLeaf); }, 1);
}

EdgePointIndex::~EdgePointIndex() = default;
EdgePointIndex::EdgePointIndex(EdgePointIndex&&) noexcept = default;
EdgePointIndex& EdgePointIndex::operator=(EdgePointIndex&&) noexcept = default;

bool EdgePointIndex::nearest(Vec3 p, TissuePair pair, double radius_mm, Vec3& found) const {
  const auto at = trees_->by_pair.find(pair);
  if (at == trees_->by_pair.end()) return false;
  NearestWithin result{radius_mm * radius_mm};
  const std::array<double, 3> query = {p.x, p.y, p.z};
  at->second.tree->findNeighbors(result, query.data(), nanoflann::SearchParams());
  if (result.any) found = at->second.cloud.points[result.index];
  return result.any;
}

std::vector<Match> match_points(std::span<const SourcePoint> sources, const EdgePointIndex& targets,
                                const MatchOptions& options) {
  std::vector<Candidate> found(sources.size());
  parallel_for(sources.size(), [&](std::size_t n) {
    found[n] = match_one(sources[n], targets);
    found[n].match.source = static_cast<std::uint32_t>(n);
  });
  std::erase_if(found, [](const Candidate& c) { return c.reach < 0; });
  drop_farthest(found, options.outlier_share);
  std::vector<Match> matches;
  matches.reserve(found.size());
  for (const Candidate& c : found) matches.push_back(c.match);
  return matches;
}

}  // namespace anatomesh
