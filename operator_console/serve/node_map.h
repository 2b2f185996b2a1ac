// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/queries.h"

namespace shoal::console {

/// The map of a running node, kept by asking for what has changed.
class NodeMap {
 public:
  /// Asks the node. @param status  its answer to "status", as new as the map is to be.
  /// @throws std::runtime_error when the node does not answer, or not as one does; the next time all is asked
  /// for.
  const mapping::MissionView& refresh(const std::string& state_dir, const nlohmann::ordered_json& status);

  /// How long the node took for the last answer; nothing for the whole map that a node tells once which tells
  /// changes from then on.
  std::chrono::steady_clock::duration asking() const { return asking_; }

 private:
  mapping::MissionView view_;
  std::string has_;  // digest of view_.map
  std::chrono::steady_clock::duration asking_{};
};

}  // namespace shoal::console
