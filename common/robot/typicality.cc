// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/typicality.h"

#include <algorithm>
#include <cmath>

namespace shoal::robot {

Typicality::Typicality(const mapping::LocalBelief& belief) {
  const int32_t vocabulary =
      belief.groups.empty() ? 0 : belief.groups.back().first + belief.groups.back().size;
  std::vector<int64_t> counts(static_cast<size_t>(vocabulary));
  int64_t total = 0;
  for (const mapping::BelievedTopic& topic : belief.topics) {
    for (const world::WordCount& w : topic.words) counts[static_cast<size_t>(w.word)] += w.count;
    total += topic.weight;
  }
  for (const mapping::BelievedTopic& topic : belief.topics) {
    if (topic.weight <= 0) continue;
    std::vector<float> profile(static_cast<size_t>(vocabulary));
    double squares = 0;
    for (const world::WordCount& w : topic.words) {
      const auto word = static_cast<size_t>(w.word);
      const double own = std::sqrt(static_cast<double>(w.count) / static_cast<double>(topic.weight));
      const double all = std::sqrt(static_cast<double>(counts[word]) / static_cast<double>(total));
      const double left = std::max(own - all / 2, 0.0);
      profile[word] = static_cast<float>(left);
      squares += left * left;
    }
    if (!(squares > 0)) continue;
    const auto length = static_cast<float>(std::sqrt(squares));
    for (float& value : profile) value /= length;
    profile_.emplace(topic.id, std::move(profile));
  }
}

int32_t Typicality::of(const std::vector<world::WordCount>& words, world::TopicId topic) const {
  const auto found = profile_.find(topic);
  if (found == profile_.end() || words.empty()) return 0;
  int64_t total = 0;
  for (const world::WordCount& w : words) total += w.count;
  double product = 0;
  for (const world::WordCount& w : words) {
    product += std::sqrt(static_cast<double>(w.count) / static_cast<double>(total)) *
               double{found->second.at(static_cast<size_t>(w.word))};
  }
  return static_cast<int32_t>(std::clamp(std::lround(product * kMost), 0L, long{kMost}));
}

}  // namespace shoal::robot
