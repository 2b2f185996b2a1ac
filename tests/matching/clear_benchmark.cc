// SPDX-License-Identifier: BSD-3-Clause
// How long rectify() takes on noisy association graphs: 15 % of the true edges missing and as many false
// ones, one giant component; and on the sparse regime, 5 % missing and none false. Beside it a dense
// eigensolver on the noisy graph. Arguments: robots, topics a robot.
#include <benchmark/benchmark.h>

#include <Eigen/Eigenvalues>

#include "graph_matrices.h"
#include "noisy_graph.h"
#include "shoal/matching/clear.h"
#include "shoal/matching/eigenpairs.h"

namespace shoal::matching {
namespace {

NoisyGraph graphOf(const benchmark::State& state, double noise_missing, double false_per_true) {
  return makeNoisyGraph(static_cast<int>(state.range(0)), static_cast<int>(state.range(1)), noise_missing,
                        false_per_true, 1);
}

void rectifyGraph(benchmark::State& state, double missing, double false_per_true) {
  const NoisyGraph noisy = graphOf(state, missing, false_per_true);
  Clustering clustering;
  for (auto _ : state) {
    clustering = rectify(noisy.graph);
    benchmark::DoNotOptimize(clustering);
  }
  state.counters["edges"] = static_cast<double>(noisy.graph.edges.size());
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
    ->Args({200, 20})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_RectifyNoisy)->Args({500, 20})->Args({1000, 20})->Iterations(3)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_RectifySparse)->Args({12, 10})->Args({12, 25})->Args({100, 20})->Unit(benchmark::kMillisecond);

// What rectify() would need at the least with Eigen's dense solver of the whole spectrum.
void BM_DenseNoisy(benchmark::State& state) {
  const Eigen::MatrixXd matrix(complement(graphOf(state, .15, .15).graph));
  for (auto _ : state) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(matrix);
    benchmark::DoNotOptimize(solver.eigenvectors().sum());
  }
}

BENCHMARK(BM_DenseNoisy)->Args({12, 10})->Args({12, 25})->Args({50, 20})->Unit(benchmark::kMillisecond);
BENCHMARK(BM_DenseNoisy)->Args({100, 20})->Iterations(1)->Unit(benchmark::kMillisecond);

// Where our dense solver stops being the faster one: the choice of kDenseSize. Argument: robots of 10 topics.
void BM_Eigenpairs(benchmark::State& state, bool dense) {
  const auto matrix = complement(makeNoisyGraph(static_cast<int>(state.range(0)), 10, .15, .15, 1).graph);
  for (auto _ : state) {
    if (dense) {
      benchmark::DoNotOptimize(denseEigenpairsAbove(matrix, .5));
    } else {
      benchmark::DoNotOptimize(krylovEigenpairsAbove(matrix, .5));
    }
  }
}

BENCHMARK_CAPTURE(BM_Eigenpairs, dense, true)->DenseRange(10, 60, 10)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(BM_Eigenpairs, krylov, false)->DenseRange(10, 60, 10)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace shoal::matching
