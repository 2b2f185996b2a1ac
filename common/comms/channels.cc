// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/channels.h"

#include <algorithm>
#include <stdexcept>

namespace shoal::comms {
namespace {

constexpr std::string_view kPrefix = "SHOAL_";

// Not std::isupper: the locale has no say here.
bool isUpper(char c) { return c >= 'A' && c <= 'Z'; }
bool isUpperOrDigit(char c) { return isUpper(c) || (c >= '0' && c <= '9'); }

bool isNode(std::string_view node) {
  return !node.empty() && node.size() <= kMaxNodeLength && std::ranges::all_of(node, isUpperOrDigit);
}

bool isKind(std::string_view kind) { return !kind.empty() && std::ranges::all_of(kind, isUpper); }

}  // namespace

std::string channelName(std::string_view node, std::string_view kind) {
  if (!isNode(node)) {
    throw std::invalid_argument("a node's name must be 1 to 16 of A-Z and 0-9, got \"" + std::string(node) +
                                "\"");
  }
  if (!isKind(kind)) {
    throw std::invalid_argument("a channel's kind must be one or more of A-Z, got \"" + std::string(kind) +
                                "\"");
  }
  std::string channel = std::string(kPrefix) + std::string(node) + "_" + std::string(kind);
  if (channel.size() > kMaxChannelLength) {
    throw std::invalid_argument("a channel's name may have 63 characters, got \"" + channel + "\"");
  }
  return channel;
}

std::optional<ChannelName> parseChannel(std::string_view channel) {
  if (channel.size() > kMaxChannelLength || !channel.starts_with(kPrefix)) return std::nullopt;
  channel.remove_prefix(kPrefix.size());
  const size_t bar = channel.find('_');
  if (bar == std::string_view::npos) return std::nullopt;
  const std::string_view node = channel.substr(0, bar);
  const std::string_view kind = channel.substr(bar + 1);
  if (!isNode(node) || !isKind(kind)) return std::nullopt;
  return ChannelName{std::string(node), std::string(kind)};
}

}  // namespace shoal::comms
