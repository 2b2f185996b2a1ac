// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>

#include "shoal/matching/descriptors.h"
#include "shoal/random.h"

namespace shoal::matching {

/// Robots that each have `num_topics` topics of 1.5 times as many classes; a topic is `tokens` words drawn
/// from a vocabulary: `background` of them from one common distribution, the others from one of the class.
/// Both are heavy in a few words (the fourth power of a uniform number), so descriptors are sparse.
inline DescriptorSet makeManyTopics(int num_robots, int num_topics, int vocabulary, int tokens,
                                    double background, uint64_t seed) {
  DescriptorSet topics{vocabulary, {}, {}};
  const auto size = static_cast<uint64_t>(vocabulary);
  for (int robot = 0; robot < num_robots; ++robot) {
    std::vector<Descriptor>& own = topics.robots.emplace_back();
    for (int k = 0; k < num_topics; ++k) {
      Random random(seed, static_cast<uint64_t>(robot), static_cast<uint64_t>(k));
      const uint64_t topic_class =
          static_cast<uint64_t>(k) + random.below(2) * (static_cast<uint64_t>(num_topics) / 2);
      std::map<int32_t, int64_t> count;
      for (int t = 0; t < tokens; ++t) {
        const uint64_t first = random.uniform() < background ? 0 : mix64(topic_class + 1) % size;
        const double x = random.uniform();
        ++count[static_cast<int32_t>(
            (first + static_cast<uint64_t>(x * x * x * x * static_cast<double>(size / 4))) % size)];
      }
      Descriptor& topic = own.emplace_back();
      topic.slot = k;
      for (const auto& [word, n] : count) topic.entries.push_back({word, n});
    }
  }
  return topics;
}

}  // namespace shoal::matching
