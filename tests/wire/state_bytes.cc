// SPDX-License-Identifier: BSD-3-Clause
// shoal_state_bytes WORLD [SEEDS]: what a robot's whole state takes on the wire against what is observed, in
// cells of what size, with how many labels (K) and words (V), and how good the fused map then is: a table of
// docs/benchmarks.md. Twelve robots fly in this process. With SEEDS: coarse against fine over so many seeds
// of learning, in pairs.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "flight.h"
#include "shoal/eval/team_learning.h"
#include "shoal/eval/topic_tally.h"
#include "shoal/matching/matcher.h"
#include "state_cost.h"

namespace {

using namespace shoal;  // NOLINT: a main file

using wire::Knobs;
using wire::Team;

constexpr int kRobots = wire::kFlyingRobots;
constexpr int32_t kImages = 60;

// As if every `fold` words of a kind were one.
void foldWords(mapping::LocalBelief& belief, int32_t fold) {
  std::vector<world::WordGroup> folded = belief.groups;
  int32_t first = 0;
  for (world::WordGroup& group : folded) {
    group.first = first;
    group.size = (group.size + fold - 1) / fold;
    first += group.size;
  }
  for (mapping::BelievedTopic& topic : belief.topics) {
    std::map<int32_t, int32_t> counts;
    size_t g = 0;
    for (const auto& [word, count] : topic.words) {
      while (word >= belief.groups[g].first + belief.groups[g].size) ++g;
      counts[folded[g].first + (word - belief.groups[g].first) / fold] += count;
    }
    topic.words.clear();
    for (const auto& [word, count] : counts) topic.words.push_back({word, count});
  }
  belief.groups = std::move(folded);
}

struct Figures {
  double topics = 0, labels = 0, certainties = 0, all = 0;  // bytes, means of robots
  size_t most = 0;                                          // bytes of the robot with most
  double ami = 0;
};

Figures figuresOf(Team team, mapping::Detail detail, const eval::TruthOfCell& truth) {
  Figures figures;
  for (mapping::LocalBelief& belief : team) {
    belief.detail = detail;
    const wire::StateCost cost = wire::costOfState(belief);
    figures.topics += static_cast<double>(cost.topics.datagrams) / kRobots;
    figures.labels += static_cast<double>(cost.labels.datagrams) / kRobots;
    figures.certainties += static_cast<double>(cost.certainties.datagrams) / kRobots;
    figures.most = std::max(figures.most, cost.datagrams());
  }
  figures.all = figures.topics + figures.labels + figures.certainties;
  const eval::Stacked stacked = eval::stackTeam(std::move(team));
  const eval::TeamTally tally = eval::tally(stacked.beliefs, truth, eval::FusionRule::kNewestWins);
  const matching::MatcherOptions matcher{.matcher = "shoal",
                                         .similarity = matching::usualSimilarity("shoal")};
  figures.ami = eval::scoreMatcher(stacked, tally, matcher).ami;
  return figures;
}

void printRow(const std::string& name, const Team& team, const eval::TeamWords& words) {
  size_t cells = 0, topics = 0;
  for (const mapping::LocalBelief& belief : team) {
    cells += belief.cells.size();
    topics += belief.topics.size();
  }
  const eval::TruthOfCell truth = words.truthOfCell();
  const Figures fine = figuresOf(team, mapping::Detail::kFine, truth);
  const Figures coarse = figuresOf(team, mapping::Detail::kCoarse, truth);
  std::printf(
      "| %s | %zu | %.1f | %.0f | %.0f | %.0f | %.0f, %.0f | %.0f (%zu) | %.0f (%zu) | %.3f, %.3f |\n",
      name.c_str(), cells / kRobots, static_cast<double>(topics) / kRobots, fine.topics, coarse.topics,
      fine.labels, fine.certainties, coarse.certainties, fine.all, fine.most, coarse.all, coarse.most,
      fine.ami, coarse.ami);
  std::fflush(stdout);
}

void printCurves(const std::string& world) {
  const auto usual = wire::usualKnobs();
  std::puts(
      "| setting | cells | topics | topics fine | coarse | labels, times | certainties fine, coarse "
      "| all fine (most) | all coarse (most) | AMI fine, coarse |");
  std::puts("|---|---|---|---|---|---|---|---|---|---|");
  {
    const eval::TeamWords words = wire::look(world, kImages);
    const Team team = wire::learn(words, 1, usual);
    printRow("60 images, cells of " + std::to_string(words.cell_size_m).substr(0, 3) + " m, K 32, V 1200",
             team, words);
    for (const int32_t k : {4, 8, 16, 64}) {
      Knobs knobs = usual;
      knobs.max_topics = k;
      printRow("K " + std::to_string(k), wire::learn(words, 1, knobs), words);
    }
    for (const int32_t k : {8, 16, 32}) {
      Knobs knobs = usual;
      knobs.max_topics = k;
      knobs.twin_similarity = 1;
      printRow("K " + std::to_string(k) + ", twins told apart", wire::learn(words, 1, knobs), words);
    }
    for (const int32_t fold : {2, 4, 8}) {
      Team folded = team;
      for (mapping::LocalBelief& belief : folded) foldWords(belief, fold);
      const world::WordGroup& last = folded.front().groups.back();
      printRow("V " + std::to_string(last.first + last.size), folded, words);
    }
  }
  for (const int32_t images : {15, 30, 120, 250}) {
    const eval::TeamWords words = wire::look(world, images);
    printRow(std::to_string(images) + " images", wire::learn(words, 1, usual), words);
  }
  for (const std::string cell : {"0.4", "1.6", "3.2"}) {
    const eval::TeamWords words = wire::look(world, kImages, std::stod(cell));
    printRow("cells of " + cell + " m", wire::learn(words, 1, usual), words);
  }
}

void printPairs(const std::string& world, int seeds) {
  const auto usual = wire::usualKnobs();
  const eval::TeamWords words = wire::look(world, kImages);
  std::puts("| seed | AMI fine | coarse | coarse - fine |\n|---|---|---|---|");
  double sum = 0, squares = 0, fine_sum = 0;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Team team = wire::learn(words, static_cast<uint64_t>(seed), usual);
    const double fine = figuresOf(team, mapping::Detail::kFine, words.truthOfCell()).ami;
    const double coarse = figuresOf(team, mapping::Detail::kCoarse, words.truthOfCell()).ami;
    sum += coarse - fine;
    squares += (coarse - fine) * (coarse - fine);
    fine_sum += fine;
    std::printf("| %d | %.3f | %.3f | %+.3f |\n", seed, fine, coarse, coarse - fine);
    std::fflush(stdout);
  }
  const double mean = sum / seeds;
  const double error = std::sqrt(std::max(0.0, squares / seeds - mean * mean) / std::max(1, seeds - 1));
  std::printf("%s, %d seeds: mean AMI fine %.3f, coarse - fine %+.4f, standard error %.4f\n", world.c_str(),
              seeds, fine_sum / seeds, mean, error);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    if (argc < 2 || argc > 3) throw std::invalid_argument("usage: shoal_state_bytes WORLD [SEEDS]");
    int seeds = 0;
    if (argc == 3) {
      const std::string_view text = argv[2];
      const auto read = std::from_chars(text.data(), text.data() + text.size(), seeds);
      if (read.ec != std::errc{} || read.ptr != text.data() + text.size() || seeds < 2 || seeds > 1000)
        throw std::invalid_argument("SEEDS lie in [2, 1000]");
    }
    if (seeds > 0) {
      printPairs(argv[1], seeds);
    } else {
      printCurves(argv[1]);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "shoal_state_bytes: %s\n", error.what());
    return 1;
  }
  return 0;
}
