#include "benchmarks/stages/case.h"

#include <utility>

#include "benchmarks/stages/bricks.h"

namespace anatomesh::benchmarks {

// The last one only, as they may be large.
const LabelImage& image_of(const Case& c) {
  static std::pair<std::size_t, std::size_t> made;
  static LabelImage image;
  if (made != std::pair(c.side, c.labels)) {
    image = {};
    image = wavy_bricks(c.side, c.labels);
    made = {c.side, c.labels};
  }
  return image;
}

Options whole_way(const Case& c) {
  Options options;
  options.threads = c.threads;
  options.lattice.bcc_size_mm = c.bcc_size_mm;
  options.lattice.fidelity_stage = FidelityStage::lattice;
  return options;
}

void count_tets(benchmark::State& state, std::size_t tets) {
  state.counters["tets"] = static_cast<double>(tets);
  state.counters["tets_per_second"] =
      benchmark::Counter(static_cast<double>(tets), benchmark::Counter::kIsIterationInvariantRate);
}

void cases_of_stage(benchmark::internal::Benchmark* b) {
  b->UseRealTime()->ArgNames({"side", "labels", "bcc", "threads"})->Unit(benchmark::kMillisecond);
  for (const std::int64_t bcc : {3200, 1600, 800, 400}) b->Args({128, 4, bcc, kThreads});
  for (const std::int64_t side : {100, 200, 460}) b->Args({side, 4, 8 * side, kThreads});
  for (const std::int64_t count : {1, 30, 700}) b->Args({128, count, 800, kThreads});
  b->Args({128, 4, 800, 1});
}

}  // namespace anatomesh::benchmarks
