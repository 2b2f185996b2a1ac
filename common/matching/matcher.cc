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

Clustering matchGraph(const AssociationGraph& graph, const MatcherOptions& options) {
  if (options.matcher == "components") return matchByComponents(graph);
  ClearOptions clear;
  clear.distinct = options.keepsOwnApart();
  return rectify(graph, clear);
}

// Matches the topics that have words; each other topic gets a label of its own.
template <class Match>
Clustering withoutEmptyTopics(const DescriptorSet& topics, Match match) {
  DescriptorSet worded = topics;
  std::vector<bool> empty;
  for (std::vector<Descriptor>& robot : worded.robots) {
    for (const Descriptor& topic : robot) empty.push_back(topic.entries.empty());
    std::erase_if(robot, [](const Descriptor& topic) { return topic.entries.empty(); });
  }
  const Clustering matched = match(std::as_const(worded));
  std::vector<int> label;
  int universe = matched.universe;
  auto next = matched.label.begin();
  for (const bool alone : empty) label.push_back(alone ? universe++ : *next++);
  return numberByFirstAppearance(label, universe);
}

}  // namespace

void check(const MatcherOptions& options) {
  const std::vector<std::string>& names = matcherNames();
  if (std::find(names.begin(), names.end(), options.matcher) == names.end()) {
    std::string built;
    for (const std::string& name : names) built += (built.empty() ? "" : ", ") + name;
    throw std::invalid_argument("matcher \"" + options.matcher + "\" is unknown; built are: " + built);
  }
  const bool discounts = options.similarity == kDiscounted;
  const bool on_graph = options.matcher == "clear" || options.matcher == "components";
  if (!discounts) similarityNamed(options.similarity);
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

Clustering match(const DescriptorSet& topics, const MatcherOptions& options) {
  check(options);
  check(topics);
  if (options.matcher == "id") return matchById(topics);
  return withoutEmptyTopics(topics, [&](const DescriptorSet& worded) {
    const bool distinct = options.keepsOwnApart();
    const double sigma = options.leastSimilarity();
    if (options.matcher == "shoal") return matchShoal(worded, sigma, distinct);
    if (options.similarity == kDiscounted) {
      return matchGraph(associationGraph(worded, discountedSimilarity(worded), sigma, !distinct), options);
    }
    const Similarity similarity = similarityNamed(options.similarity);
    if (options.matcher == "hungarian") return matchSequentially(worded, similarity);
    if (options.matcher == "incremental") return matchIncrementally(worded, similarity, sigma);
    return matchGraph(associationGraph(worded, similarity, sigma, !distinct), options);
  });
}

Clustering match(const AssociationGraph& graph, const MatcherOptions& options) {
  check(options);
  if (options.matcher != "clear" && options.matcher != "components") {
    throw std::invalid_argument(
        "matcher \"" + options.matcher +
        "\" looks at the topics themselves and cannot match a graph; \"clear\" and \"components\" can");
  }
  return matchGraph(graph, options);
}

}  // namespace shoal::matching
