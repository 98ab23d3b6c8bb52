// The only door to threads. Results never depend on how many there are: loops write to places of their
// own, and sums are added up in fixed blocks in a fixed order.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace anatomesh {

/// While it lives, the loops below use at most this many threads (0: all cores).
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Calls body(begin, end) on disjoint ranges that cover [0, n), of at most `grain` items each, in
/// parallel and in no fixed order. The ranges themselves do not depend on the number of threads:
/// they are [0, grain), [grain, 2 grain), ...
void parallel_blocks(std::size_t n, std::size_t grain,
                     const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Calls body(i) for every i in [0, n) in parallel.
template <class Body>
void parallel_for(std::size_t n, const Body& body, std::size_t grain = 1024) {
  parallel_blocks(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

/// Sum of block_sum(begin, end) over the fixed blocks of `grain` items, added in block order: the same
/// bits for any number of threads.
double parallel_sum(std::size_t n, std::size_t grain,
                    const std::function<double(std::size_t begin, std::size_t end)>& block_sum);

}  // namespace anatomesh
