// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "shoal/world/ids.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// What a team of robots knows, matched: which topics are one label. Made by who matches them; a robot looks
/// at its own map again with it (Learner::lookAgain()).
struct TeamTopics {
  static constexpr int64_t kMostWords = int64_t{1} << 30;  ///< of one topic

  /// A topic of another robot, as it was told.
  struct Foreign {
    world::RobotId robot{};
    int32_t label = 0;
    std::vector<world::WordCount> words;  ///< ascending by word; counts > 0 that add up to at most kMostWords
    bool operator==(const Foreign&) const = default;
  };
  std::map<world::TopicId, int32_t> own;  ///< the label of each of the robot's own topics
  std::vector<Foreign> others;  ///< in an order that all agree on; those of other labels may be there
  bool operator==(const TeamTopics&) const = default;
};

}  // namespace shoal::topics
