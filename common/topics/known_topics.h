// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/topics/topic_slots.h"
#include "shoal/world/ids.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// A topic that a robot knows before it has seen anything, from an earlier mission. Its words speak in the
/// conditional as the robot's own do; what the robot tells of its topics are its own words alone.
struct KnownTopic {
  world::TopicId id{};                  ///< kept
  std::vector<world::WordCount> words;  ///< ascending by word, not empty
};

/// @throws std::invalid_argument naming what is wrong: more than `max_topics`, an id out of range or twice,
/// words
///         out of order or range, counts that add up to more than 2^30.
void check(const std::vector<KnownTopic>& known, int32_t vocabulary_size, int32_t max_topics);

/// Known topics in the first slots, in their order, created at mission time 0.
std::vector<TopicSlots::Named> namesOf(const std::vector<KnownTopic>& known);

/// One above their highest id.
int32_t numIdsOf(const std::vector<KnownTopic>& known);

/// Equal for equal topics, and almost surely only then; 0 for none.
uint64_t hashOf(const std::vector<KnownTopic>& known);

/// Takes `less` out of `words`, both ascending, every word of `less` being there as often at least.
void subtract(std::vector<world::WordCount>& words, std::span<const world::WordCount> less);

}  // namespace shoal::topics
