// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>
#include <utility>
#include <vector>

#include "shoal/mapping/belief_store.h"
#include "shoal/matching/descriptors.h"

namespace shoal::mapping {

/// A topic as it was heard, its parts put together.
struct HeardTopic {
  world::RobotId robot{};
  world::TopicId id{};
  world::Timestamp created;
  int64_t weight = 0;
  int64_t cells = 0;  ///< cells of its robot's map that carry it
  std::vector<int32_t> group_sizes;
  std::vector<world::WordCount> words;  ///< ascending by word
};

/// The topics of all robots in canonical order (robot number, topic id), whatever arrived first.
struct StackedTopics {
  std::vector<HeardTopic> topics;       ///< all with weight > 0
  std::vector<int32_t> vertex;          ///< per topic: its vertex among `descriptors`, or -1
  matching::DescriptorSet descriptors;  ///< the topics that take part in matching
};

/// Puts the heard topics together and picks those that take part in matching: they label at least one cell
/// and were learned with what most robots learn with (common_settings.h) and with the vocabulary layout that
/// most of these share (ties go to the layout of the lowest robot). Others keep a label of their own.
/// @param excluded  Robots that count as never heard.
StackedTopics stack(const BeliefStore& beliefs, const std::set<world::RobotId>& excluded = {});

/// The same by one who has counted the cells of every robot's map by topic; those without any may lack.
/// Cost: O(words) of all topics.
StackedTopics stack(const BeliefStore& beliefs, const std::set<world::RobotId>& excluded,
                    const std::map<std::pair<world::RobotId, world::TopicId>, int64_t>& cells);

}  // namespace shoal::mapping
