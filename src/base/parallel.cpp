#include "base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <vector>

namespace anatomesh {

struct ThreadLimit::Impl {
  explicit Impl(std::size_t threads) : control(tbb::global_control::max_allowed_parallelism, threads) {}
  tbb::global_control control;
};

ThreadLimit::ThreadLimit(int threads) {
  const int cores = tbb::info::default_concurrency();
  impl_ = std::make_unique<Impl>(static_cast<std::size_t>(threads > 0 ? threads : cores));
}

ThreadLimit::~ThreadLimit() = default;

void parallel_blocks(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& body) {
  const std::size_t blocks = (n + grain - 1) / grain;
  if (blocks == 1) return body(0, n);
  tbb::parallel_for(std::size_t{0}, blocks, [&](std::size_t b) { body(b * grain, std::min(n, (b + 1) * grain)); });
}

double parallel_sum(std::size_t n, std::size_t grain,
                    const std::function<double(std::size_t begin, std::size_t end)>& block_sum) {
  std::vector<double> sums((n + grain - 1) / grain);
  parallel_blocks(n, grain, [&](std::size_t begin, std::size_t end) { sums[begin / grain] = block_sum(begin, end); });
  double total = 0;
  for (const double s : sums) total += s;
  return total;
}

}  // namespace anatomesh
