// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <utility>
#include <vector>

#include "shoal/world/ids.h"

namespace shoal::mapping {

/// A robot's topic, as a cell shows it.
using Voice = std::pair<world::RobotId, world::TopicId>;

/// The global label of every robot's topic: all that a new matching changes.
class LabelTable {
 public:
  /// @param voice  robot in [0, 9999], topic in [0, kMaxTopicId].
  void set(const Voice& voice, world::GlobalLabel label) {
    const auto robot = static_cast<size_t>(number(voice.first));
    const auto topic = static_cast<size_t>(number(voice.second));
    if (robot >= labels_.size()) labels_.resize(robot + 1);
    if (topic >= labels_[robot].size()) labels_[robot].resize(topic + 1, kNone);
    labels_[robot][topic] = label;
  }

  /// The label of a topic that was never set is its own number.
  world::GlobalLabel of(const Voice& voice) const {
    const auto robot = static_cast<size_t>(number(voice.first));
    const auto topic = static_cast<size_t>(number(voice.second));
    if (robot < labels_.size() && topic < labels_[robot].size() && labels_[robot][topic] != kNone)
      return labels_[robot][topic];
    return world::globalLabel(voice.first, voice.second);
  }

  void clear() { labels_.clear(); }

 private:
  static constexpr world::GlobalLabel kNone{-1};
  std::vector<std::vector<world::GlobalLabel>> labels_;  // by robot, then topic
};

}  // namespace shoal::mapping
