// What is measured: an image, a lattice and a number of threads.
#pragma once

#include <benchmark/benchmark.h>

#include <cstddef>
#include <cstdint>

#include "anatomesh/image_to_mesh.h"
#include "anatomesh/label_image.h"

namespace anatomesh::benchmarks {

/// The arguments of a benchmark.
struct Case {
  std::size_t side, labels;
  double bcc_size_mm;
  int threads;

  explicit Case(const benchmark::State& state)
      : side(static_cast<std::size_t>(state.range(0))),
        labels(static_cast<std::size_t>(state.range(1))),
        bcc_size_mm(0.01 * static_cast<double>(state.range(2))),
        threads(static_cast<int>(state.range(3))) {}
};

inline constexpr std::int64_t kThreads = 2;

/// The image of a case, made once for all benchmarks in a row that take it.
const LabelImage& image_of(const Case& c);

/// Options for the whole way, with the paper's parameters but for the spacing.
Options whole_way(const Case& c);

/// Reports tetrahedra, and tetrahedra a second.
void count_tets(benchmark::State& state, std::size_t tets);

/// One quantity at a time: tetrahedra, voxels, labels, threads.
void cases_of_stage(benchmark::internal::Benchmark* b);

}  // namespace anatomesh::benchmarks
