// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "shoal/world/ids.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// One topic: exact counts of the words assigned to it.
struct TopicCounts {
  world::TopicId id{};
  world::Timestamp created;             ///< mission time of the observation that opened it
  int64_t weight = 0;                   ///< words assigned, the sum of `words`; > 0
  std::vector<world::WordCount> words;  ///< ascending by word
};

/// A cell as its robot labels it now.
struct CellLabel {
  world::CellIndex cell;
  world::TopicId topic{};
  float certainty = 0;           ///< in [0, 1]; each model says what it means
  float surprise = 0;            ///< >= 0, the most that it was at any sight: see SurpriseScale
  int32_t seen_observation = 0;  ///< last image that put words here
  world::Timestamp seen;
};

/// What one robot's model says at one moment.
struct Snapshot {
  int32_t vocabulary_size = 0;
  std::vector<TopicCounts> topics;  ///< ascending by id, none empty
  std::vector<CellLabel> cells;     ///< ascending by cell
};

}  // namespace shoal::topics
