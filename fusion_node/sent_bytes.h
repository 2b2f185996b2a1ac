// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>

#include "shoal/wire/heartbeat_codec.h"

namespace shoal::fusion_node {

/// What one node has sent in all its lives that were heard. A heartbeat counts the bytes of its own process;
/// one that comes back counts from nothing.
class SentBytes {
 public:
  /// Of so many processes it is known which spoke last; who was heard longest ago counts as ended.
  static constexpr size_t kMaxProcesses = 8;

  struct Sum {
    int64_t bytes = 0;
    std::array<int64_t, wire::Heartbeat::kNumClasses> of_class{};
  };

  void heard(const wire::Heartbeat& heartbeat);

  /// The last heartbeats of all lives, added up; INT64_MAX where that is more.
  Sum sum() const;

 private:
  using Process = std::pair<int32_t, int32_t>;  // host, pid
  using Age = std::pair<int32_t, int64_t>;      // epoch, mission time
  struct Life {
    Age age;
    uint64_t heard = 0;  // the how-many-th heartbeat was its last
    Sum sent;
  };
  std::map<Process, Life> lives_;
  Sum ended_;  // of lives before them
  uint64_t heard_ = 0;
};

}  // namespace shoal::fusion_node
