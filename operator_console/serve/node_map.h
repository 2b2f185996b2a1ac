// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

#include <nlohmann/json.hpp>

#include "shoal/mapping/map_changes.h"

namespace shoal::console {

/// The map as a running node tells it: whole the first time, then what has changed.
class NodeMap {
 public:
  struct News {
    mapping::MapChange change;
    double cell_size_m = 1;
    nlohmann::ordered_json labels;  ///< as the answer to "labels"
  };

  /// Asks the node in a state folder.
  /// @throws std::runtime_error when it does not answer, or nonsense; the next time it tells everything.
  News ask(const std::string& state_dir);

  /// How long the node took the last time; nothing for its first answer, which is whole.
  std::chrono::steady_clock::duration asking() const { return asking_; }

 private:
  std::string has_;  // digest of what was told last
  std::chrono::steady_clock::duration asking_{};
};

}  // namespace shoal::console
