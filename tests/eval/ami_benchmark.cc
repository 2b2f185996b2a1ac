// SPDX-License-Identifier: BSD-3-Clause
// AMI of ten million cells, beside scikit-learn's adjusted_mutual_info_score in the same run where Debian's
// python3-sklearn is installed. Labels in patches of 500 cells, a tenth of them wrong.
#include <benchmark/benchmark.h>

#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "shoal/eval/ami.h"
#include "shoal/random.h"

namespace {

struct Labellings {
  std::vector<int> label, truth;
};

Labellings labellings(size_t cells, uint64_t labels, uint64_t classes) {
  shoal::Random random(1);
  Labellings made{std::vector<int>(cells), std::vector<int>(cells)};
  for (size_t n = 0; n < cells; ++n) {
    made.truth[n] =
        static_cast<int>(n % 500 == 0 ? random.below(classes) : static_cast<uint64_t>(made.truth[n - 1]));
    made.label[n] = random.uniform() < 0.1 ? static_cast<int>(random.below(labels)) : made.truth[n];
  }
  return made;
}

void Ours(benchmark::State& state) {
  const Labellings cells =
      labellings(static_cast<size_t>(state.range(0)), static_cast<uint64_t>(state.range(1)),
                 static_cast<uint64_t>(state.range(2)));
  for (auto _ : state) {
    benchmark::DoNotOptimize(shoal::eval::ami(shoal::eval::contingency(cells.label, cells.truth)));
  }
}

void ScikitLearn(benchmark::State& state) {
  const std::string program =
      "/usr/bin/python3 -c 'import time, numpy as n; from sklearn.metrics import adjusted_mutual_info_score "
      "as a\n"
      "g = n.random.default_rng(1); t = n.repeat(g.integers(0, " +
      std::to_string(state.range(2)) + ", " + std::to_string(state.range(0) / 500) +
      "), 500)\nl = n.where(g.random(t.size) < .1, g.integers(0, " + std::to_string(state.range(1)) +
      ", t.size), t)\ns = time.process_time(); a(t, l, average_method=\"max\")\nprint(time.process_time() - "
      "s)'";
  for (auto _ : state) {
    std::FILE* pipe = popen(program.c_str(), "r");
    double seconds = 0;
    const bool answered = pipe != nullptr && std::fscanf(pipe, "%lf", &seconds) == 1;
    if (pipe != nullptr) pclose(pipe);
    if (!answered) {
      state.SkipWithError("needs python3-sklearn");
      return;
    }
    state.SetIterationTime(seconds);
  }
}

BENCHMARK(Ours)->Args({10'000'000, 10, 10})->Args({10'000'000, 30, 20})->Unit(benchmark::kMillisecond);
BENCHMARK(ScikitLearn)
    ->Args({10'000'000, 10, 10})
    ->Args({10'000'000, 30, 20})
    ->UseManualTime()
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
