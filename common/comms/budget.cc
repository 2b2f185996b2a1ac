// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/budget.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "shoal/comms/packet.h"
#include "shoal/demand.h"

namespace shoal::comms {
namespace {

constexpr int64_t kSecond = 1'000'000;
constexpr int64_t kLargestBudget = 1'000'000'000'000;

}  // namespace

Budget::Budget(int64_t bytes_per_s)
    : bytes_per_s_(bytes_per_s), last_us_(std::numeric_limits<int64_t>::min()), binding_(-(Wide{1} << 120)) {
  if (bytes_per_s < 0 || bytes_per_s > kLargestBudget) {
    throw std::invalid_argument("a budget must lie in 0 (unlimited) to 10^12 bytes/s, got " +
                                std::to_string(bytes_per_s));
  }
  worst_.budget = bytes_per_s;
}

// t >= t_i + (P - P_i + s) / B, times B, with what depends on i on one side.
Budget::Wide Budget::key(const Sent& sent) const {
  return Wide{sent.at_us} * bytes_per_s_ - Wide{sent.before} * kSecond;
}

int64_t Budget::earliest(int64_t now_us, size_t bytes) const {
  SHOAL_DEMAND(bytes > 0);
  now_us = std::max(now_us, last_us_);
  if (bytes_per_s_ == 0) return now_us;
  const int64_t after = sent_ + static_cast<int64_t>(bytes);
  Wide binding = binding_;
  for (const Sent& sent : recent_) {
    if (after - sent.before <= bytes_per_s_) break;  // and so for every later one
    binding = std::max(binding, key(sent));
  }
  const Wide due = binding + Wide{after} * kSecond;
  if (due <= Wide{now_us} * bytes_per_s_) return now_us;
  const Wide floor = due / bytes_per_s_ - (due % bytes_per_s_ < 0 ? 1 : 0);
  return static_cast<int64_t>(floor + (floor * bytes_per_s_ < due ? 1 : 0));
}

void Budget::spend(int64_t at_us, size_t bytes) {
  SHOAL_DEMAND(earliest(at_us, bytes) <= std::max(at_us, last_us_));
  last_us_ = std::max(at_us, last_us_);
  const Sent sent{last_us_, sent_};
  sent_ += static_cast<int64_t>(bytes);
  second_.push_back(sent);
  measure(last_us_);
  if (bytes_per_s_ == 0) return;
  recent_.push_back(sent);
  while (!recent_.empty() && sent_ - recent_.front().before > bytes_per_s_) {
    binding_ = std::max(binding_, key(recent_.front()));
    recent_.pop_front();
  }
}

void Budget::assumeExhausted(int64_t at_us, size_t largest_datagram) {
  last_us_ = std::max(at_us, last_us_);
  if (bytes_per_s_ == 0) return;
  const int64_t assumed = std::max(bytes_per_s_, static_cast<int64_t>(largest_datagram));
  binding_ = std::max(binding_, key({last_us_, sent_ - assumed}));
}

void Budget::measure(int64_t at_us) {
  while (at_us - second_.front().at_us > kSecond) second_.pop_front();
  const int64_t bytes = sent_ - second_.front().before;
  if (bytes <= worst_.bytes) return;
  const bool unlimited = bytes_per_s_ == 0;
  const bool alone = second_.size() == 1;
  worst_ = {bytes, alone && !unlimited ? std::max(bytes_per_s_, bytes) : bytes_per_s_};
}

size_t efficientDatagram(int64_t bytes_per_s, size_t overhead) {
  SHOAL_DEMAND(bytes_per_s >= 0 && overhead < 1000);
  if (bytes_per_s == 0) return kMaxWireBytes;
  size_t best = kMaxWireBytes;
  double most = 0;
  for (size_t size = kMaxWireBytes; size > overhead; --size) {
    const auto fit = static_cast<double>(std::max<int64_t>(1, bytes_per_s / static_cast<int64_t>(size)));
    const double carried = (1 - static_cast<double>(overhead) / static_cast<double>(size)) * fit / (fit + 1);
    if (carried <= most) continue;
    most = carried;
    best = size;
  }
  return best;
}

}  // namespace shoal::comms
