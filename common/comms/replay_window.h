// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>

namespace shoal::comms {

/// Which counters of a sender were seen: says of each whether it is new. What is kWidth or more below the
/// greatest counts as seen. 144 bytes, O(1).
class ReplayWindow {
 public:
  static constexpr uint32_t kWidth = 1024;

  /// True, and remembers it, when `counter` was not seen before.
  bool take(uint32_t counter) {
    if (!any_ || counter > greatest_) {
      const uint32_t ahead = any_ ? counter - greatest_ : kWidth;
      if (ahead >= kWidth) seen_.reset();
      for (uint32_t i = 1; ahead < kWidth && i <= ahead; ++i) seen_.reset((greatest_ + i) % kWidth);
      greatest_ = counter;
      any_ = true;
    } else if (greatest_ - counter >= kWidth || seen_.test(counter % kWidth)) {
      return false;
    }
    seen_.set(counter % kWidth);
    return true;
  }

 private:
  std::bitset<kWidth> seen_;  // by counter modulo kWidth
  uint32_t greatest_ = 0;
  bool any_ = false;
};

}  // namespace shoal::comms
