#include "anatomesh/assess.h"

#include "base/parallel.h"
#include "benchmarks/stages/case.h"

namespace anatomesh::benchmarks {
namespace {

void assess_(benchmark::State& state) {
  const Case c(state);
  const TetMesh mesh = image_to_mesh(image_of(c), whole_way(c)).mesh;
  const ThreadLimit limit(c.threads);
  for (auto _ : state) benchmark::DoNotOptimize(assess(mesh, &image_of(c)));
  count_tets(state, mesh.tets.size());
}

BENCHMARK(assess_)->Name("assess")->Apply(cases_of_stage);

}  // namespace
}  // namespace anatomesh::benchmarks
