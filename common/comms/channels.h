// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

namespace shoal::comms {

/// LCM's own limit for a channel's name.
inline constexpr size_t kMaxChannelLength = 63;
inline constexpr size_t kMaxNodeLength = 16;

/// Selects all of our channels; a regular expression that LCM anchors at both ends.
inline constexpr const char* kAllChannels = "SHOAL_.*";

/// A channel is SHOAL_<NODE>_<KIND>.
struct ChannelName {
  std::string node;  ///< [A-Z0-9]{1,16}: a robot ("R03") or another node ("OPERATOR").
  std::string kind;  ///< [A-Z]+: what its messages are ("TOPICS").

  friend bool operator==(const ChannelName&, const ChannelName&) = default;
};

/// "SHOAL_R03_TOPICS" from "R03" and "TOPICS".
/// @throws std::invalid_argument when a part has other characters or is empty or too long.
std::string channelName(std::string_view node, std::string_view kind);

/// The parts of a channel's name as received; nothing when it is none of ours.
[[nodiscard]] std::optional<ChannelName> parseChannel(std::string_view channel);

}  // namespace shoal::comms
