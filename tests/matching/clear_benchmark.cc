// SPDX-License-Identifier: BSD-3-Clause
// How long rectify() takes on noisy association graphs: 15 % of the true edges missing and as many false
// ones, one giant component; and on the sparse regime, 5 % missing and none false. Arguments: robots, topics
// a robot.
#include <benchmark/benchmark.h>

#include "noisy_graph.h"
#include "shoal/matching/clear.h"
#include "shoal/matching/eigenpairs.h"

namespace shoal::matching {
namespace {

void rectifyGraph(benchmark::State& state, double missing, double false_per_true) {
  const NoisyGraph noisy = makeNoisyGraph(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)),
                                          missing, false_per_true, 1);
  Clustering clustering;
  for (auto _ : state) {
    clustering = rectify(noisy.graph);
    benchmark::DoNotOptimize(clustering);
  }
  state.counters["universe"] = clustering.universe;
  state.counters["labels"] = clustering.num_labels;
}

void BM_RectifyNoisy(benchmark::State& state) { rectifyGraph(state, .15, .15); }
void BM_RectifySparse(benchmark::State& state) { rectifyGraph(state, .05, 0.); }

BENCHMARK(BM_RectifyNoisy)
    ->Args({12, 10})
    ->Args({12, 25})
    ->Args({50, 20})
    ->Args({100, 20})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_RectifySparse)->Args({12, 10})->Args({12, 25})->Args({100, 20})->Unit(benchmark::kMillisecond);

// Where the dense solver stops being the faster one: the choice of kDenseSize.
void BM_Eigenpairs(benchmark::State& state, bool dense) {
  const NoisyGraph noisy = makeNoisyGraph(static_cast<int>(state.range(0)), 10, .15, .15, 1);
  Eigen::SparseMatrix<double> matrix = -normalizedLaplacian(noisy.graph);
  for (Eigen::Index v = 0; v < matrix.rows(); ++v) matrix.coeffRef(v, v) += 1.0;
  for (auto _ : state) {
    if (dense) {
      benchmark::DoNotOptimize(denseEigenpairsAbove(matrix, .5));
    } else {
      benchmark::DoNotOptimize(krylovEigenpairsAbove(matrix, .5));
    }
  }
}

BENCHMARK_CAPTURE(BM_Eigenpairs, dense, true)->DenseRange(10, 40, 10)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Eigenpairs, krylov, false)->DenseRange(10, 40, 10)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace shoal::matching
