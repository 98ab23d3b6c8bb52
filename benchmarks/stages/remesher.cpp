// Updates of a mesh beside meshing all of its image: one ball after the other is cut out of the tissues.
#include "anatomesh/remesher.h"

#include <benchmark/benchmark.h>

#include <chrono>
#include <cmath>
#include <memory>

#include "benchmarks/stages/bricks.h"

namespace anatomesh::benchmarks {
namespace {

// About 500,000 tetrahedra with the default options.
constexpr std::size_t kSide = 256, kLabels = 150;

struct Case {
  LabelImage image;
  std::unique_ptr<Remesher> mesher;
  double seconds = 0;  // to mesh all of it
  int cuts = 0;        // so far
};

// Made once for all benchmarks.
Case& prepared() {
  static Case c;
  if (c.mesher) return c;
  c.image = wavy_bricks(kSide, kLabels);
  Options options;
  options.threads = 2;
  const auto start = std::chrono::steady_clock::now();
  c.mesher = std::make_unique<Remesher>(c.image, options);
  c.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return c;
}

// Cuts a ball out of the image, the n-th around its middle.
void cut_ball(LabelImage& image, int n, double radius_mm) {
  const double angle = 2.4 * n, middle = 0.5 * static_cast<double>(kSide);  // 2.4: no two near each other
  const double x0 = middle + 60 * std::cos(angle), y0 = middle + 60 * std::sin(angle), z0 = middle - 50 + 5.5 * n;
  std::size_t v = 0;
  for (std::size_t k = 0; k < kSide; ++k) {
    for (std::size_t j = 0; j < kSide; ++j) {
      for (std::size_t i = 0; i < kSide; ++i, ++v) {
        const double x = static_cast<double>(i) - x0, y = static_cast<double>(j) - y0, z = static_cast<double>(k) - z0;
        if (x * x + y * y + z * z <= radius_mm * radius_mm) image.voxels[v] = 0;
      }
    }
  }
}

void update(benchmark::State& state) {
  Case& c = prepared();
  double seconds = 0, whole = 0, new_tets = 0;
  for (auto _ : state) {
    state.PauseTiming();
    cut_ball(c.image, c.cuts++, 0.5 * static_cast<double>(state.range(0)));
    state.ResumeTiming();
    const UpdateReport report = c.mesher->update(c.image);
    seconds += report.seconds;
    whole += report.whole;
    new_tets += static_cast<double>(report.new_tets);
  }
  const auto updates = static_cast<double>(state.iterations());
  state.counters["tets"] = static_cast<double>(c.mesher->result().mesh.tets.size());
  state.counters["new_tets"] = new_tets / updates;
  state.counters["whole"] = whole;
  state.counters["seconds_for_all"] = c.seconds;
  state.counters["percent_of_all"] = 100 * seconds / updates / c.seconds;
}

BENCHMARK(update)
    ->UseRealTime()
    ->ArgName("diameter_mm")
    ->Arg(4)
    ->Arg(20)
    ->Arg(40)
    ->Iterations(6)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace anatomesh::benchmarks

BENCHMARK_MAIN();
