// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "shoal/wire/heartbeat_codec.h"

namespace shoal::fusion_node {

/// Tells two processes under one name from one that took the other's place: who was replaced says nothing any
/// more, but for what was still on its way: sent before the other began, or, when the other's clock is ahead,
/// within a minute after it was last heard.
class TwinWatch {
 public:
  /// At most so many names are followed, and so many processes of each.
  static constexpr size_t kMaxNames = 300, kMaxProcesses = 8;

  void heard(const std::string& node, const wire::Heartbeat& heartbeat);

  /// True once a process has gone on to speak under this name three times after another had begun to.
  bool hasTwin(const std::string& node) const;

 private:
  using Process = std::pair<int32_t, int32_t>;  // host, pid
  struct Life {
    int32_t epoch = 0;
    int64_t first_us = 0, last_us = 0;
    int64_t before_us = 0;  // last of who spoke before it first did
    uint64_t birth = 0;
  };
  struct Name {
    std::map<Process, Life> lives;
    Process speaks{};
    uint64_t births = 0;
    int returns = 0;
  };
  std::map<std::string, Name> names_;
};

}  // namespace shoal::fusion_node
