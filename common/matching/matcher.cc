// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/matcher.h"

#include <algorithm>
#include <charconv>
#include <stdexcept>
#include <utility>

#include "shoal/matching/clear.h"
#include "shoal/matching/connected_components.h"
#include "shoal/matching/discounted_similarity.h"
#include "shoal/matching/hungarian.h"
#include "shoal/matching/id_matching.h"
#include "shoal/matching/incremental_hungarian.h"
#include "shoal/matching/shoal_matching.h"

namespace shoal::matching {
namespace {

constexpr const char* kDiscounted = "discounted";

Clustering matchGraph(const AssociationGraph& graph, const MatcherOptions& options,
                      const PairConstraints& constraints, MatchMemory* memory) {
  if (options.matcher == "components") return matchByComponents(graph, constraints);
  ClearOptions clear;
  clear.distinct = options.keepsOwnApart();
  if (memory == nullptr) return rectify(graph, clear, constraints);
  Clustering clustering = rectify(graph, clear, constraints, &memory->spectra);
  memory->spectra.forgetUnused();
  return clustering;
}

std::vector<int> ownersOf(const DescriptorSet& topics) {
  std::vector<int> owner;
  for (size_t r = 0; r < topics.robots.size(); ++r)
    owner.insert(owner.end(), topics.robots[r].size(), static_cast<int>(r));
  return owner;
}

// Matches the topics that have words; each other topic gets a label of its own, or that of those it is to be
// together with.
template <class Match>
Clustering withoutEmptyTopics(const DescriptorSet& topics, const PairConstraints& constraints, bool distinct,
                              Match match) {
  DescriptorSet worded = topics;
  std::vector<int> place;
  int kept = 0;
  for (std::vector<Descriptor>& robot : worded.robots) {
    for (const Descriptor& topic : robot) place.push_back(topic.entries.empty() ? -1 : kept++);
    std::erase_if(robot, [](const Descriptor& topic) { return topic.entries.empty(); });
  }
  const Contraction contraction = contract(static_cast<int>(place.size()), constraints);
  PairConstraints kept_constraints;
  if (!constraints.empty()) {
    const Conflicts conflicts(contraction, distinct ? ownersOf(topics) : std::vector<int>{});
    kept_constraints = restrict(contraction, conflicts, place);
  }
  return extend(contraction, place, match(std::as_const(worded), kept_constraints));
}

// What a matcher that knows nothing of constraints says, made to honour them.
Clustering repaired(const DescriptorSet& topics, const Clustering& clustering,
                    const PairConstraints& constraints) {
  if (constraints.empty()) return clustering;
  const std::vector<int> owner = ownersOf(topics);
  return repair(contract(static_cast<int>(owner.size()), constraints), clustering, owner);
}

void demandBuilt(const std::string& what, const std::string& name, const std::vector<std::string>& names) {
  if (std::ranges::find(names, name) != names.end()) return;
  std::string built;
  for (const std::string& each : names) built += (built.empty() ? "" : ", ") + each;
  throw std::invalid_argument(what + " \"" + name + "\" is unknown; built are: " + built);
}

}  // namespace

void check(const MatcherOptions& options) {
  demandBuilt("matcher", options.matcher, matcherNames());
  const bool discounts = options.similarity == kDiscounted;
  const bool on_graph = options.matcher == "clear" || options.matcher == "components";
  std::vector<std::string> similarities = similarityNames();
  similarities.emplace_back(kDiscounted);
  demandBuilt("similarity", options.similarity, similarities);
  if (discounts && !on_graph && options.matcher != "shoal") {
    throw std::invalid_argument(
        "matcher \"" + options.matcher +
        "\" compares topics two by two; \"discounted\" is for: clear, components, shoal");
  }
  if (!discounts && options.matcher == "shoal") {
    throw std::invalid_argument("matcher \"shoal\" compares by \"discounted\", got similarity \"" +
                                options.similarity + "\"");
  }
  const double sigma = options.leastSimilarity();
  if (!(sigma >= 1e-9 && sigma <= 1.0)) {
    throw std::invalid_argument("sigma must lie in [1e-9, 1], got " + std::to_string(sigma));
  }
  if (!options.keepsOwnApart() && !mergesOwn(options.matcher) && options.matcher != "clear") {
    throw std::invalid_argument(
        "matcher \"" + options.matcher +
        "\" keeps the labels of one robot apart; merging them is built for: clear, components, shoal");
  }
  if (options.keepsOwnApart() && options.matcher == "components") {
    throw std::invalid_argument(
        "matcher \"components\" joins all that edges join; the labels of one robot stay apart with: id, "
        "hungarian, incremental, clear, shoal");
  }
}

bool mergesOwn(std::string_view matcher) { return matcher == "components" || matcher == "shoal"; }

double MatcherOptions::leastSimilarity() const { return sigma.value_or(usualSigma(matcher)); }

const std::vector<std::string>& matcherNames() {
  static const std::vector<std::string> names{"id",         "hungarian", "incremental",
                                              "components", "clear",     "shoal"};
  return names;
}

bool usesSigma(std::string_view matcher) { return matcher != "id" && matcher != "hungarian"; }

std::string usualSimilarity(std::string_view matcher) {
  if (matcher == "hungarian") return "l2";
  return matcher == "shoal" ? kDiscounted : "cosine";
}

MatcherOptions usualMatcher() { return {.matcher = "shoal", .similarity = usualSimilarity("shoal")}; }

double usualSigma(std::string_view matcher) { return matcher == "shoal" ? kShoalSigma : 0.75; }

std::optional<double> parseSigma(const std::string& text) {
  if (text == "auto") return std::nullopt;
  double sigma = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), sigma);
  if (error != std::errc{} || end != text.data() + text.size() || !(sigma >= 1e-9) || sigma > 1) {
    throw std::invalid_argument("sigma must be auto or a number in (0, 1], got \"" + text + "\"");
  }
  return sigma;
}

Clustering match(const DescriptorSet& topics, const MatcherOptions& options,
                 const PairConstraints& constraints, MatchMemory* memory) {
  check(options);
  check(topics);
  if (options.matcher == "id") return repaired(topics, matchById(topics), constraints);
  const bool distinct = options.keepsOwnApart();
  return withoutEmptyTopics(
      topics, constraints, distinct, [&](const DescriptorSet& worded, const PairConstraints& kept) {
        const double sigma = options.leastSimilarity();
        if (options.matcher == "shoal") return matchShoal(worded, sigma, distinct, kept);
        if (options.similarity == kDiscounted) {
          return matchGraph(associationGraph(worded, discountedSimilarity(worded), sigma, !distinct), options,
                            kept, memory);
        }
        const Similarity similarity = similarityNamed(options.similarity);
        if (options.matcher == "hungarian")
          return repaired(worded, matchSequentially(worded, similarity), kept);
        if (options.matcher == "incremental")
          return repaired(worded, matchIncrementally(worded, similarity, sigma), kept);
        NeighbourMemory* const neighbours = memory == nullptr ? nullptr : &memory->neighbours;
        return matchGraph(associationGraph(worded, similarity, sigma, !distinct, neighbours), options, kept,
                          memory);
      });
}

Clustering match(const AssociationGraph& graph, const MatcherOptions& options,
                 const PairConstraints& constraints) {
  check(options);
  if (options.matcher != "clear" && options.matcher != "components") {
    throw std::invalid_argument(
        "matcher \"" + options.matcher +
        "\" looks at the topics themselves and cannot match a graph; \"clear\" and \"components\" can");
  }
  return matchGraph(graph, options, constraints, nullptr);
}

}  // namespace shoal::matching
