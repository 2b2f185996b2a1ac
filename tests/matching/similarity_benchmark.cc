// SPDX-License-Identifier: BSD-3-Clause
// How long the association graph of many sparse topics takes, cosine at .75, by the inverted index and by
// comparing all pairs. Arguments: robots of 20 topics each; words in the vocabulary.
#include <benchmark/benchmark.h>

#include "many_topics.h"
#include "shoal/matching/association_graph.h"

namespace shoal::matching {
namespace {

double byPairs(const Descriptor& a, const Descriptor& b) { return cosine(a, b); }

void associate(benchmark::State& state, Similarity similarity) {
  const DescriptorSet topics =
      makeManyTopics(static_cast<int>(state.range(0)), 20, static_cast<int>(state.range(1)), 1000, .3, 1);
  size_t num_edges = 0;
  for (auto _ : state) num_edges = associationGraph(topics, similarity, .75).edges.size();
  size_t words = 0;
  for (const auto& robot : topics.robots) {
    for (const Descriptor& topic : robot) words += topic.entries.size();
  }
  state.counters["edges"] = static_cast<double>(num_edges);
  state.counters["words"] = static_cast<double>(words) / static_cast<double>(20 * state.range(0));
}

BENCHMARK_CAPTURE(associate, cosine_by_index, &cosine)
    ->Args({12, 1500})
    ->Args({100, 15000})
    ->Args({500, 15000})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(associate, cosine_by_pairs, &byPairs)
    ->Args({12, 1500})
    ->Args({100, 15000})
    ->Iterations(1)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace shoal::matching
