// Matching of the mesh's interface vertices to edge points of the image.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "anatomesh/types.h"
#include "boundary/edge_points.h"

namespace anatomesh {

/// A vertex on an interface of the mesh.
struct SourcePoint {
  Vec3 position_mm;
  std::span<const TissueId> tissues;  ///< those of its tetrahedra, two or more different ones; owned by the caller
  double radius_mm = 0;               ///< a target must be nearer than this; > 0
};

/// A source point and where it should go.
struct Match {
  std::uint32_t source = 0;  ///< position in the span of source points
  Vec3 target_mm;
  double confidence = 0;  ///< 0 to 1; see match_points()
};

/// The edge points, arranged for searches: a k-d tree for each pair of tissues.
/// Keeps what it needs; const use by several threads at once is fine. Building costs about 0.1 us a point.
class EdgePointIndex {
 public:
  explicit EdgePointIndex(std::span<const EdgePoint> points);
  ~EdgePointIndex();
  EdgePointIndex(EdgePointIndex&&) noexcept;
  EdgePointIndex& operator=(EdgePointIndex&&) noexcept;

  /// Finds the point of the pair nearest to p and nearer than radius_mm (of equally near ones any, but always the
  /// same). False if there is none. Cost: about 0.5 us.
  bool nearest(Vec3 p, TissuePair pair, double radius_mm, Vec3& found) const;

 private:
  struct Trees;
  std::unique_ptr<Trees> trees_;
};

/// How match_points() treats what it finds.
struct MatchOptions {
  double outlier_share = 0;  ///< 0 to 1: share of the matches, those farthest for their radius, that is dropped
};

/// For each source point the nearest target of its two tissues; with three or more tissues the mean of the nearest
/// targets of all its pairs that have one within the radius. Sources without any target have no match. Ordered by
/// source. The confidence is (1 - (d / 2r)^2)^2 for a target at distance d and a radius r: 1 at the
/// target, 0.56 at the radius. The same for any number of threads. Cost: one search a pair of each source point.
std::vector<Match> match_points(std::span<const SourcePoint> sources, const EdgePointIndex& targets,
                                const MatchOptions& options = {});

}  // namespace anatomesh
