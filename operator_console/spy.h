// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <regex>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/comms/packet.h"
#include "shoal/comms/window_meter.h"

namespace shoal::console {

/// Listens to everything on a multicast group, or in a recording, and says what it was: what lcm-spy does, on
/// a terminal. Bytes are bytes on the wire, all headers counted. Nothing that is heard is trusted.
class Spy {
 public:
  /// @param shown  Only channels that match as a whole; their last message is decoded too. None: all,
  /// undecoded.
  /// @param of_all  Rates are of all that was heard, as of a recording; else of the last ten seconds.
  explicit Spy(std::optional<std::regex> shown, bool of_all = false)
      : shown_(std::move(shown)), of_all_(of_all) {}

  /// A message that came at `at_s`, any clock in seconds. Memory is bounded: channels after the first 1000
  /// are counted only.
  void hear(const comms::Packet& packet, double at_s);

  /// {"seconds", "messages", "channels": [{"channel", "type", "messages", "hz", "bytes_per_s", "bytes",
  /// "ago_s", "refused", "last" when decoded}], "nodes": [{"node", "budget", "bytes", "bytes_per_s",
  /// "worst"}], "unlisted"}. Rates of channels by the listener's clock; of nodes by mission time, without
  /// what stays on this host, and "worst" the fullest window as a share of the budget.
  nlohmann::ordered_json json(double now_s) const;

  /// The same as tables of at most 80 columns, decoded messages below.
  std::string text(double now_s, bool shortens = true) const;

 private:
  struct Channel {
    int64_t messages = 0, bytes = 0, refused = 0;
    double last_s = 0;
    std::deque<std::pair<double, size_t>> recent;
    std::string type;
    comms::Packet last;
  };
  struct Node {
    int64_t budget = -1;  // unknown
    int64_t bytes = 0;
    std::deque<std::pair<int64_t, size_t>> sent;  // mission time, bytes: the latest
    int64_t first_us = 0, last_us = 0;
  };
  bool isShown(const std::string& channel) const;
  bool hearNode(const comms::Packet& packet);

  std::optional<std::regex> shown_;
  bool of_all_;
  std::map<std::string, Channel> channels_;
  std::map<std::string, Node> nodes_;
  int64_t messages_ = 0, unlisted_ = 0;
  std::optional<double> first_s_;
};

}  // namespace shoal::console
