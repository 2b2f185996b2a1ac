// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/moment.h"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <fstream>

#include <spdlog/fmt/fmt.h>

namespace shoal::fusion_node {
namespace {

constexpr double kDayUs = 86'400e6;
constexpr double kMostDays = 30;

std::string bootId() {
  std::string id;
  std::ifstream("/proc/sys/kernel/random/boot_id") >> id;
  return id;
}

}  // namespace

Moment thisMoment() {
  static const std::string kBootId = bootId();
  Moment now;
  now.wall_us = std::chrono::duration_cast<std::chrono::microseconds>(
                    std::chrono::system_clock::now().time_since_epoch())
                    .count();
  timespec since_boot{};
  if (::clock_gettime(CLOCK_BOOTTIME, &since_boot) != 0) return now;
  now.boot_us = int64_t{since_boot.tv_sec} * 1'000'000 + since_boot.tv_nsec / 1000;
  now.boot_id = kBootId;
  return now;
}

Gap passedBetween(const Moment& then, const Moment& now) {
  if (!then.boot_id.empty() && then.boot_id == now.boot_id)
    return {std::max<int64_t>(now.boot_us - then.boot_us, 0), {}};
  const double days = (static_cast<double>(now.wall_us) - static_cast<double>(then.wall_us)) / kDayUs;
  if (days < 0) return {0, fmt::format("by the wall clock it is {:.3f} days in the future", -days)};
  if (days > kMostDays) return {0, fmt::format("by the wall clock it is {:.0f} days old", days)};
  return {now.wall_us - then.wall_us, {}};
}

}  // namespace shoal::fusion_node
