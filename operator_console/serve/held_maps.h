// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "operator_console/mission_sources.h"
#include "operator_console/serve/mission_feed.h"

namespace shoal::console {

/// The map as any node of the mission held it, made when somebody looks: holdingOf() of the recording, or of
/// what the running node remembers. The last few are kept; of a running mission one counts for five seconds.
/// Safe to call from any thread; one is made at a time.
class HeldMaps {
 public:
  struct Held {
    std::shared_ptr<const Moment> moment;
    nlohmann::ordered_json says;  ///< Holding::json()
  };

  HeldMaps(Where where, const MissionFeed& feed) : where_(std::move(where)), feed_(feed) {}

  /// @param at_s  mission time; none: the newest.
  /// @throws std::runtime_error as recordingOf() and holdingOf().
  Held of(const std::string& node, std::optional<double> at_s);

 private:
  struct Kept {
    std::string node;
    std::optional<double> at_s;
    uint64_t sequence;
    std::chrono::steady_clock::time_point made;
    Held held;
  };
  Held make(const std::string& node, std::optional<double> at_s) const;

  const Where where_;
  const MissionFeed& feed_;
  std::mutex mutex_;
  std::deque<Kept> kept_;  // guarded by mutex_; the newest in front
};

}  // namespace shoal::console
