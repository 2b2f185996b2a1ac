// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/topic_matching.h"

#include <map>

namespace shoal::mapping {
namespace {

// Topics by number: those stacked first, then any others that pairs name.
class Numbers {
 public:
  explicit Numbers(const StackedTopics& stacked) {
    for (const HeardTopic& topic : stacked.topics) (*this)({topic.robot, topic.id});
  }
  int operator()(const Topic& topic) { return known_.try_emplace(topic, size()).first->second; }
  int size() const { return static_cast<int>(known_.size()); }

 private:
  std::map<Topic, int> known_;
};

}  // namespace

matching::Clustering matchTopics(const StackedTopics& stacked, const matching::MatcherOptions& options,
                                 const Judgement& judgement, matching::MatchMemory* memory) {
  Numbers numbers(stacked);
  const auto numbered = [&](const std::vector<TopicPair>& pairs) {
    std::vector<std::pair<int, int>> result;
    for (const auto& [a, b] : pairs) {
      if (judgement.excluded.contains(a.first) || judgement.excluded.contains(b.first)) continue;
      const int first = numbers(a), second = numbers(b);
      result.emplace_back(first, second);
    }
    return result;
  };
  const matching::PairConstraints pairs{numbered(judgement.links), numbered(judgement.apart)};
  if (pairs.empty()) {
    const matching::Contraction alone = matching::contract(numbers.size(), {});
    return matching::extend(alone, stacked.vertex, matching::match(stacked.descriptors, options, {}, memory));
  }
  std::vector<int> place(stacked.vertex.begin(), stacked.vertex.end());
  place.resize(static_cast<size_t>(numbers.size()), -1);
  std::vector<int> owner;
  if (options.keepsOwnApart())
    for (const HeardTopic& topic : stacked.topics) owner.push_back(number(topic.robot));
  const matching::Contraction contraction = matching::contract(numbers.size(), pairs);
  matching::Clustering all =
      matching::extend(contraction, place,
                       matching::match(stacked.descriptors, options,
                                       matching::restrict(contraction, {contraction, owner}, place), memory));
  all.label.resize(stacked.topics.size());
  return matching::numberByFirstAppearance(all.label, all.universe);
}

}  // namespace shoal::mapping
