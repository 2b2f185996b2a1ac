// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include <nlohmann/json_fwd.hpp>

#include "fusion_node/mission_file.h"
#include "shoal/comms/log_reader.h"
#include "shoal/comms/seal.h"

namespace shoal::console {

/// What became of the seals of a recording's messages.
struct SealCounts {
  int64_t sealed = 0;    ///< messages that carry one
  bool checked = false;  ///< with a key; else they were removed unseen
  int64_t refused = 0;   ///< messages on our channels without a right one, left out; 0 unless checked

  nlohmann::ordered_json json() const;
  std::string text() const;  ///< a line, or nothing when there is nothing to say
};

/// Says in the log, once of each recording, when its seals were removed unseen.
void warnOfSeals(const std::string& path, const SealCounts& seals);

/// Reads the messages of a recording, or of what a node remembers (MissionFile), without their seals. With a
/// key, messages on our channels that it did not seal are left out, and those that somebody said again.
class MessageLog {
 public:
  /// @param key_file  empty: seals are removed unseen.
  /// @throws std::runtime_error as LogReader, std::invalid_argument as SealKey::read().
  explicit MessageLog(const std::string& path, const std::string& key_file = {});

  std::optional<comms::LogEvent> next();

  /// True for what a node remembers: not all that it heard.
  bool isMemory() const { return file_.has_value(); }

  const comms::LogCounts& counts() const;
  const SealCounts& seals() const { return seals_; }

 private:
  std::optional<comms::LogEvent> nextOfFile();

  std::optional<comms::SealKey> key_;
  std::optional<comms::LogReader> log_;
  std::optional<fusion_node::MissionFileReader> file_;  // one of the two
  SealCounts seals_;
  std::set<std::pair<uint32_t, uint32_t>> heard_;  // sessions and counters of right seals
};

}  // namespace shoal::console
