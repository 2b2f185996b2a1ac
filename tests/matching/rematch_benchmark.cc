// SPDX-License-Identifier: BSD-3-Clause
// One robot's topics have changed since the last matching: match() with and without a memory of that one, in
// one run. Arguments: robots of 11 topics each (three of 1200 words in three groups).
#include <benchmark/benchmark.h>

#include <string>
#include <vector>

#include "many_topics.h"
#include "shoal/matching/association_graph.h"
#include "shoal/matching/clear.h"
#include "shoal/matching/discounted_similarity.h"
#include "shoal/matching/match_memory.h"
#include "shoal/matching/matcher.h"

namespace shoal::matching {
namespace {

DescriptorSet teamOf(const benchmark::State& state) {
  DescriptorSet topics = makeManyTopics(static_cast<int>(state.range(0)), 11, 1200, 1500, .3, 1);
  topics.group_first = {0, 400, 800};
  return topics;
}

// Each time another robot has seen one image more.
class Growing {
 public:
  explicit Growing(DescriptorSet topics) : topics_(std::move(topics)) {}
  const DescriptorSet& next() {
    for (Descriptor& topic : topics_.robots[++step_ % topics_.robots.size()])
      topic.entries[step_ % topic.entries.size()].weight += 1;
    return topics_;
  }

 private:
  DescriptorSet topics_;
  size_t step_ = 0;
};

void rematch(benchmark::State& state, const MatcherOptions& options, bool with_memory) {
  Growing team(teamOf(state));
  MatchMemory memory;
  match(team.next(), options, {}, &memory);
  int labels = 0;
  for (auto _ : state) {
    const DescriptorSet& topics = team.next();
    labels = match(topics, options, {}, with_memory ? &memory : nullptr).num_labels;
  }
  state.counters["labels"] = labels;
}

// What is left of it without the edges.
void rematchGraph(benchmark::State& state, bool with_memory) {
  Growing team(teamOf(state));
  SpectrumMemory memory;
  rectify(associationGraph(team.next(), &cosine, .75), {}, {}, &memory);
  for (auto _ : state) {
    state.PauseTiming();
    const AssociationGraph graph = associationGraph(team.next(), &cosine, .75);
    state.ResumeTiming();
    benchmark::DoNotOptimize(rectify(graph, {}, {}, with_memory ? &memory : nullptr));
    memory.forgetUnused();
  }
}

void discount(benchmark::State& state) {
  Growing team(teamOf(state));
  for (auto _ : state) benchmark::DoNotOptimize(discountedSimilarity(team.next()));
}

const MatcherOptions kClear{.matcher = "clear"}, kComponents{.matcher = "components"};

#define BOTH_TEAMS(...) BENCHMARK_CAPTURE(__VA_ARGS__)->Arg(12)->Arg(100)->Unit(benchmark::kMillisecond)
BOTH_TEAMS(rematch, clear_anew, kClear, false);
BOTH_TEAMS(rematch, clear_with_memory, kClear, true);
BOTH_TEAMS(rematch, components_anew, kComponents, false);
BOTH_TEAMS(rematch, components_with_memory, kComponents, true);
BOTH_TEAMS(rematchGraph, clear_anew, false);
BOTH_TEAMS(rematchGraph, clear_with_memory, true);
BOTH_TEAMS(rematch, shoal, usualMatcher(), false);
BENCHMARK(discount)->Arg(12)->Arg(100)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace shoal::matching
