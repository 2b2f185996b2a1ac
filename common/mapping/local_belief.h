// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "shoal/mapping/piece.h"
#include "shoal/world/ids.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::mapping {

/// A topic with its exact counts, as its robot holds it.
struct BelievedTopic {
  world::TopicId id{};
  world::Timestamp created;
  int64_t weight = 0;                   ///< words assigned
  std::vector<world::WordCount> words;  ///< exact, ascending by word
  bool operator==(const BelievedTopic&) const = default;
};

/// A cell as its robot labels it.
struct BelievedCell {
  world::CellIndex cell;
  world::TopicId topic{};
  world::Timestamp seen;
  float certainty = 0;  ///< in [0, 1]
  bool operator==(const BelievedCell&) const = default;
};

/// All that one robot believes at one moment: its topics and its labelled cells.
struct LocalBelief {
  world::RobotId robot{};
  world::Version version;  ///< of the latest observation in it
  std::vector<world::WordGroup> groups;
  std::vector<BelievedTopic> topics;  ///< ascending by id
  std::vector<BelievedCell> cells;    ///< ascending by cell
};

/// A topic's counts as integers fit to travel: divided by a thousandth of their L2 norm, when that is above
/// 1, and rounded half up; words that round to 0 are left out. One step for all words, so that the word
/// groups keep their weights. With n words left out the cosine to the exact counts stays above 1 - n /
/// 8,000,000.
std::vector<world::WordCount> quantize(const std::vector<world::WordCount>& counts);

}  // namespace shoal::mapping
