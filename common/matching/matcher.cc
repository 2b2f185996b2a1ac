// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/matcher.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "shoal/matching/clear.h"
#include "shoal/matching/hungarian.h"
#include "shoal/matching/id_matching.h"

namespace shoal::matching {
namespace {

Clustering clear(const AssociationGraph& graph, bool distinct) {
  ClearOptions options;
  options.distinct = distinct;
  return rectify(graph, options);
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
    const bool planned = options.matcher == "shoal" || options.matcher == "incremental";
    throw std::invalid_argument("matcher \"" + options.matcher +
                                (planned ? "\" is not built yet" : "\" is unknown") +
                                "; built are: " + built);
  }
  similarityNamed(options.similarity);
  if (!(options.sigma >= 1e-9 && options.sigma <= 1.0)) {
    throw std::invalid_argument("sigma must lie in [1e-9, 1], got " + std::to_string(options.sigma));
  }
  if (!options.distinct && options.matcher != "clear") {
    throw std::invalid_argument("matcher \"" + options.matcher +
                                "\" keeps the labels of one robot apart; merging them is built for: clear");
  }
}

const std::vector<std::string>& matcherNames() {
  static const std::vector<std::string> names{"id", "hungarian", "clear"};
  return names;
}

std::string usualSimilarity(std::string_view matcher) { return matcher == "hungarian" ? "l2" : "cosine"; }

Clustering match(const DescriptorSet& topics, const MatcherOptions& options) {
  check(options);
  check(topics);
  if (options.matcher == "id") return matchById(topics);
  const Similarity similarity = similarityNamed(options.similarity);
  return withoutEmptyTopics(topics, [&](const DescriptorSet& worded) {
    if (options.matcher == "hungarian") return matchSequentially(worded, similarity);
    return clear(associationGraph(worded, similarity, options.sigma, !options.distinct), options.distinct);
  });
}

Clustering match(const AssociationGraph& graph, const MatcherOptions& options) {
  check(options);
  if (options.matcher != "clear") {
    throw std::invalid_argument("matcher \"" + options.matcher +
                                "\" looks at the topics themselves and cannot match a graph; \"clear\" can");
  }
  return clear(graph, options.distinct);
}

}  // namespace shoal::matching
