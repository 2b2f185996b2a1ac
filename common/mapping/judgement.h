// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/edit.h"
#include "shoal/mapping/topic_groups.h"

namespace shoal::mapping {

/// What became of an edit.
enum class Standing {
  kInForce,
  kUndone,     ///< by a later edit
  kReplaced,   ///< a later edit says otherwise of the same topic, pair or robot
  kOverruled,  ///< a link that contradicts later ones
  kVoid        ///< of a robot's earlier life, or of an edit that nobody holds
};
std::string_view toText(Standing standing);

using TopicPair = std::pair<Topic, Topic>;

/// What a topic is called, and how new that is: greater is later.
struct NameGiven {
  size_t order = 0;
  std::string text;
};

/// All that operators decided, taken together. A pure function of the edits and of the robots' epochs.
struct Judgement {
  std::set<world::RobotId> excluded;
  std::vector<TopicPair> links;  ///< the same thing; ascending; never against `apart`
  std::vector<TopicPair> apart;  ///< not the same; ascending
  std::map<Topic, NameGiven> names;

  /// The newest name given to any of these topics; empty when there is none.
  std::string nameOf(std::span<const Topic> topics) const;
};

/// The edits of a state, in the order in which they count.
std::vector<Edit> editsOf(const BeliefStore& beliefs);

/// Takes edits together: undone ones are left out, of the others the newest decides on its topic, pair or
/// robot, and a link that contradicts newer ones does not count.
/// @param edits      In the order in which they count.
/// @param standings  When not null: what became of each.
Judgement judge(std::span<const Edit> edits, const BeliefStore& beliefs,
                std::vector<Standing>* standings = nullptr);
Judgement judge(const BeliefStore& beliefs);

}  // namespace shoal::mapping
