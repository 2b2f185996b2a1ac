// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/wall_pacer.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace shoal::comms {

WallPacer::WallPacer(const WallPacerOptions& options, WallTime wall)
    : options_(options), wall_(std::move(wall)) {
  if (options.gap_us < 0 || options.gap_us > 1'000'000 || options.burst < 1 || options.burst > 1'000'000) {
    throw std::invalid_argument("pacing needs a gap of 0 to 1000000 us and a burst of 1 to 1000000, got " +
                                std::to_string(options.gap_us) + " us and " + std::to_string(options.burst));
  }
  paid_until_us_ = wall_.now_us();
}

void WallPacer::pace() {
  int64_t now_us = wall_.now_us();
  paid_until_us_ = std::max(paid_until_us_, now_us) + options_.gap_us;
  if (paid_until_us_ - now_us <= options_.burst * options_.gap_us) return;
  const int64_t wake_us = paid_until_us_ - (options_.burst + 1) / 2 * options_.gap_us;
  for (; now_us < wake_us; now_us = wall_.now_us()) wall_.sleep_us(wake_us - now_us);
}

bool WallPacer::isFree() const {
  const int64_t now_us = wall_.now_us();
  return std::max(paid_until_us_ - now_us, int64_t{0}) + options_.gap_us <= options_.burst * options_.gap_us;
}

}  // namespace shoal::comms
