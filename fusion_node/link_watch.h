// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "shoal/wire/heartbeat_codec.h"

namespace shoal::fusion_node {

/// How much of what a node says arrives here: the bytes that were heard of it beside those that its
/// heartbeats say it has sent, over its last minute of mission time.
class LinkWatch {
 public:
  /// At most so many names are followed, and so many heartbeats of each.
  static constexpr size_t kMaxNames = 300, kMaxBeats = 64;

  /// A message of the link that arrived, of any kind. A heartbeat goes to claimed() first.
  /// @param bytes  on the wire, all headers counted.
  void heard(const std::string& node, size_t bytes);

  /// What it says of itself, before heard() counts the message that says so.
  void claimed(const std::string& node, const wire::Heartbeat& heartbeat);

  /// In [0, 1]; nothing before three heartbeats of one life, or where it has sent nothing between them.
  std::optional<double> shareOf(const std::string& node) const;

  /// Bytes that it had said before its last heartbeat and that were not heard. 0 only when all was, from its
  /// start on: what came twice counts too, below 0. Nothing before it was heard.
  std::optional<int64_t> missedOf(const std::string& node) const;

 private:
  struct Beat {
    int64_t time_us = 0, sent = 0, heard = 0;
  };
  struct Node {
    int32_t pid = 0;
    int64_t heard = 0;
    std::deque<Beat> beats;
  };
  std::map<std::string, Node> nodes_;
};

}  // namespace shoal::fusion_node
