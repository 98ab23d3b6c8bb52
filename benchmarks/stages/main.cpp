// bench_stages: each stage and the whole way on generated images, by Google Benchmark. The arguments of a benchmark are
// the voxels along a side of the image, its labels, the spacing of the lattice in percent of a voxel, and the threads.
#include <benchmark/benchmark.h>

#include "anatomesh/image_to_mesh.h"
#include "base/parallel.h"
#include "benchmarks/stages/bricks.h"
#include "benchmarks/stages/case.h"
#include "deform/deform.h"
#include "lattice/label_lattice.h"
#include "pipeline/final_fidelity.h"
#include "pipeline/surface_sizes.h"

namespace anatomesh::benchmarks {
namespace {

// What the stages of one case work on, with the paper's parameters but for the spacing.
struct Work {
  const Case of;
  const ThreadLimit limit;
  const Progress quiet;
  const Stage stage;
  const TissueImage image;
  const DeformOptions options;
  LatticePlan plan;

  explicit Work(const benchmark::State& state)
      : of(state),
        limit(of.threads),
        stage(quiet, "benchmark", 0, 1),
        image(make_tissue_image(image_of(of))),
        options(strict()) {
    set_root(plan, image, of.bcc_size_mm, of.bcc_size_mm / 4);
    plan.fidelity.assign(image.labels.size(), 0.95);
  }
  TissueMesh lattice() const { return LabelLattice(image, plan).build(stage).mesh; }

 private:
  static DeformOptions strict() {
    DeformOptions options;
    options.min_dihedral_deg = 20;
    options.max_dihedral_deg = 150;
    return options;
  }
};

void labels(benchmark::State& state) {
  const Case c(state);
  const ThreadLimit limit(c.threads);
  const LabelImage& image = image_of(c);
  for (auto _ : state) benchmark::DoNotOptimize(make_tissue_image(image));
  state.counters["voxels_per_second"] =
      benchmark::Counter(static_cast<double>(image.voxels.size()), benchmark::Counter::kIsIterationInvariantRate);
}

void lattice(benchmark::State& state) {
  const Work work(state);
  std::size_t tets = 0;
  for (auto _ : state) tets = work.lattice().tets.size();
  count_tets(state, tets);
}

void approach(benchmark::State& state) {
  const Work work(state);
  const TissueMesh lattice = work.lattice();
  for (auto _ : state) {
    state.PauseTiming();
    TissueMesh mesh = lattice;
    state.ResumeTiming();
    Deformer(work.image, work.options, work.stage).approach(mesh, work.stage);
  }
  count_tets(state, tissue_tets(lattice));
}

void finish(benchmark::State& state) {
  const Work work(state);
  const Deformer deformer(work.image, work.options, work.stage);
  TissueMesh approached = work.lattice();
  deformer.approach(approached, work.stage);
  std::size_t tets = 0;
  for (auto _ : state) {
    state.PauseTiming();
    TissueMesh mesh = approached;
    state.ResumeTiming();
    deformer.finish(mesh, {}, work.stage);
    tets = tissue_tets(mesh);
  }
  count_tets(state, tets);
}

void fidelity(benchmark::State& state) {
  const Work work(state);
  const TissueMesh mesh = work.lattice();
  for (auto _ : state) benchmark::DoNotOptimize(measure_fidelity(mesh, work.image, work.stage));
  count_tets(state, tissue_tets(mesh));
}

void image_to_mesh_(benchmark::State& state) {
  const Case c(state);
  std::size_t tets = 0;
  for (auto _ : state) tets = image_to_mesh(image_of(c), whole_way(c)).mesh.tets.size();
  count_tets(state, tets);
}

// All that there is in the image is a ball of six voxels: what a call costs at least.
void fixed_cost(benchmark::State& state) {
  const Case c(state);
  const LabelImage image = small_ball(c.side, 6);
  std::size_t tets = 0;
  Options options;
  options.threads = c.threads;
  for (auto _ : state) tets = image_to_mesh(image, options).mesh.tets.size();
  count_tets(state, tets);
}

void default_options(benchmark::State& state) {
  const Case c(state);
  std::size_t tets = 0;
  Options options;
  options.threads = c.threads;
  for (auto _ : state) tets = image_to_mesh(image_of(c), options).mesh.tets.size();
  count_tets(state, tets);
}

BENCHMARK(labels)->Name("labels")->Apply(cases_of_stage);
BENCHMARK(lattice)->Name("lattice")->Apply(cases_of_stage);
BENCHMARK(approach)->Name("approach")->Apply(cases_of_stage);
BENCHMARK(finish)->Name("finish")->Apply(cases_of_stage);
BENCHMARK(fidelity)->Name("fidelity")->Apply(cases_of_stage);
BENCHMARK(image_to_mesh_)->Name("image_to_mesh")->Apply(cases_of_stage);
BENCHMARK(image_to_mesh_)
    ->Name("image_to_mesh_large")
    ->UseRealTime()
    ->ArgNames({"side", "labels", "bcc", "threads"})
    ->Unit(benchmark::kMillisecond)
    ->Iterations(1)
    ->Args({256, 4, 1000, kThreads})
    ->Args({256, 4, 500, kThreads})
    ->Args({256, 4, 300, kThreads})
    ->Args({256, 4, 200, kThreads});
BENCHMARK(fixed_cost)
    ->Name("fixed_cost")
    ->UseRealTime()
    ->ArgNames({"side", "labels", "bcc", "threads"})
    ->Unit(benchmark::kMillisecond)
    ->Args({128, 1, 0, kThreads})
    ->Args({256, 1, 0, kThreads});
BENCHMARK(default_options)
    ->Name("default_options")
    ->UseRealTime()
    ->ArgNames({"side", "labels", "bcc", "threads"})
    ->Unit(benchmark::kMillisecond)
    ->Args({128, 1, 0, kThreads})
    ->Args({128, 4, 0, kThreads});
// The one whose instructions are counted: see instructions.py.
BENCHMARK(image_to_mesh_)
    ->Name("counted")
    ->UseRealTime()
    ->ArgNames({"side", "labels", "bcc", "threads"})
    ->Iterations(1)
    ->Args({32, 3, 600, 1});

}  // namespace
}  // namespace anatomesh::benchmarks

BENCHMARK_MAIN();
