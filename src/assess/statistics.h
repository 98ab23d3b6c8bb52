// Percentiles.
#pragma once

#include <cstddef>
#include <vector>

namespace anatomesh::assess_detail {

/// The value below which `percent` (0 to 100) of the values lie, interpolated between the two nearest ranks; NaN when
/// there are none. Reorders the values. Cost: linear.
double percentile(std::vector<double>& values, double percent);

/// A value and the weight (>= 0) it has. Single precision: there are up to hundreds of millions at a time.
struct Weighted {
  float value;
  float weight;
};

/// The smallest value such that those up to it carry `share` (0 to 1) of the whole weight; every value counts the same
/// when no weight is above 0. NaN when there are none. Reorders the values. Cost: linear.
double weighted_quantile(std::vector<Weighted>& values, double share);

}  // namespace anatomesh::assess_detail
