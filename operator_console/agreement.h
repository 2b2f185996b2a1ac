// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "shoal/wire/heartbeat_codec.h"

namespace shoal::console {

/// Whether a robot has seen all that it was to see.
bool hasLanded(const wire::Heartbeat& robot);

/// What keeps the nodes of a mission from agreeing, from the last heartbeat of each: robots that have not
/// landed or have yet to look again at their map, nodes that fuse and do not hold all that a robot has, have
/// not fused what they hold, or hold another state or another map than the first of them. One line an item;
/// empty when all agree.
std::vector<std::string> disagreements(const std::map<std::string, wire::Heartbeat>& nodes);

/// Follows the heartbeats of a mission and says when it came to agree.
class Agreement {
 public:
  /// @param nodes  the last heartbeat of each, after a new one was heard.
  void update(const std::map<std::string, wire::Heartbeat>& nodes);

  /// Mission time, by the clock that was furthest, at which the last robot was heard to have landed, and from
  /// which on all nodes agreed; nothing while they do not.
  std::optional<double> landedAt() const { return landed_s_; }
  std::optional<double> agreedAt() const { return agreed_s_; }

 private:
  std::optional<double> landed_s_, agreed_s_;
};

}  // namespace shoal::console
