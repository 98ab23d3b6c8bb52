#include "base/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <cmath>
#include <mutex>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace anatomesh {
namespace {

TEST(ParallelBlocks, CoverEachIndexOnceInFixedRanges) {
  for (const std::size_t n : {0, 1, 7, 8, 9, 1000}) {
    for (const std::size_t grain : {1, 3, 8, 5000}) {
      std::vector<std::atomic<int>> visits(n);
      parallel_blocks(n, grain, [&](std::size_t begin, std::size_t end) {
        EXPECT_EQ(begin % grain, 0u);
        EXPECT_TRUE(end == begin + grain || end == n);
        for (std::size_t i = begin; i < end; ++i) ++visits[i];
      });
      for (const auto& count : visits) EXPECT_EQ(count, 1);
    }
  }
}

TEST(ParallelFor, CallsForEachIndexOnce) {
  for (const int threads : {1, 2, 4}) {
    const ThreadLimit limit(threads);
    std::vector<std::atomic<int>> visits(5000);
    parallel_for(
        visits.size(), [&](std::size_t i) { ++visits[i]; }, 16);
    for (const auto& count : visits) EXPECT_EQ(count, 1);
  }
}

TEST(ParallelFor, PassesExceptionsOn) {
  EXPECT_THROW(parallel_for(
                   1000,
                   [](std::size_t i) {
                     if (i == 700) throw std::runtime_error("700");
                   },
                   1),
               std::runtime_error);
}

TEST(ParallelFor, MayBeNested) {
  std::vector<std::atomic<int>> visits(100 * 100);
  parallel_for(
      100,
      [&](std::size_t i) {
        parallel_for(
            100, [&](std::size_t j) { ++visits[100 * i + j]; }, 7);
      },
      3);
  for (const auto& count : visits) EXPECT_EQ(count, 1);
}

double wobbly_sum(std::size_t n, std::size_t grain) {
  return parallel_sum(n, grain, [](std::size_t begin, std::size_t end) {
    double sum = 0;
    for (std::size_t i = begin; i < end; ++i) sum += std::sin(static_cast<double>(i)) * std::pow(10.0, i % 17);
    return sum;
  });
}

TEST(ParallelSum, SameBitsForAnyNumberOfThreads) {
  std::set<double> sums;
  for (const int threads : {1, 2, 4, 7, 0}) {
    const ThreadLimit limit(threads);
    for (int repeat = 0; repeat < 5; ++repeat) sums.insert(wobbly_sum(100000, 64));
  }
  EXPECT_EQ(sums.size(), 1u);
}

TEST(ParallelSum, AddsUpAll) {
  const auto count = [](std::size_t begin, std::size_t end) { return static_cast<double>(end - begin); };
  EXPECT_EQ(parallel_sum(0, 8, count), 0);
  EXPECT_EQ(parallel_sum(12345, 8, count), 12345);
}

/// Threads that a loop ran on.
std::size_t threads_used() {
  std::mutex mutex;
  std::set<std::thread::id> threads;
  parallel_for(
      64,
      [&](std::size_t) {
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
        const std::scoped_lock lock(mutex);
        threads.insert(std::this_thread::get_id());
      },
      1);
  return threads.size();
}

TEST(ThreadLimit, IsKeptWhileItLives) {
  for (const int threads : {1, 2}) {
    const ThreadLimit limit(threads);
    EXPECT_LE(threads_used(), static_cast<std::size_t>(threads));
  }
  EXPECT_GE(threads_used(), 1u);
}

TEST(ThreadLimit, OfOneRunsOnTheCallersThread) {
  const ThreadLimit limit(1);
  const auto caller = std::this_thread::get_id();
  parallel_for(
      100, [&](std::size_t) { EXPECT_EQ(std::this_thread::get_id(), caller); }, 1);
}

}  // namespace
}  // namespace anatomesh
