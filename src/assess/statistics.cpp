#include "assess/statistics.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace anatomesh::assess_detail {

double percentile(std::vector<double>& values, double percent) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const double rank = percent / 100 * static_cast<double>(values.size() - 1);
  const auto low = static_cast<std::ptrdiff_t>(std::floor(rank));
  const auto at = values.begin() + low;
  std::nth_element(values.begin(), at, values.end());
  if (at + 1 == values.end()) return *at;
  const double above = *std::min_element(at + 1, values.end());
  return *at + (rank - static_cast<double>(low)) * (above - *at);
}

double weighted_quantile(std::vector<Weighted>& values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  double whole = 0;
  for (const Weighted& v : values) whole += v.weight;
  if (!(whole > 0)) {
    for (Weighted& v : values) v.weight = 1;
    whole = static_cast<double>(values.size());
  }
  // Halve the range that the quantile lies in, by the weight of its lower half.
  auto begin = values.begin();
  auto end = values.end();
  double missing = share * whole;
  while (end - begin > 1) {
    const auto middle = begin + (end - begin) / 2;
    std::nth_element(begin, middle, end, [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
    double lower = 0;
    for (auto v = begin; v != middle; ++v) lower += v->weight;
    if (lower >= missing) {
      end = middle;
    } else {
      missing -= lower;
      begin = middle;
    }
  }
  return begin->value;
}

}  // namespace anatomesh::assess_detail
