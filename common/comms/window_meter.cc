// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/window_meter.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "shoal/demand.h"

namespace shoal::comms {
namespace {

__extension__ using Wide = __int128;
constexpr int64_t kSecondUs = 1'000'000;

// Where a window may start: a datagram and the bytes sent before it.
struct Start {
  int64_t at_us;
  int64_t before;
  size_t index;
};

bool steeper(int64_t bytes, int64_t length, int64_t other_bytes, int64_t other_length) {
  return Wide{bytes} * other_length > Wide{other_bytes} * length;
}

// Lower convex hull of (time, bytes before), grown to the right: the start of the steepest line to a later
// point lies on it.
class Hull {
 public:
  void add(const Start& p) {
    while (hull_.size() >= 2 && !turnsLeft(hull_[hull_.size() - 2], hull_.back(), p)) hull_.pop_back();
    hull_.push_back(p);
  }

  bool empty() const { return hull_.empty(); }

  // Slopes to (at_us, bytes) rise along the hull up to the tangent and fall after it.
  Start steepestTo(int64_t at_us, int64_t bytes) const {
    size_t low = 0;
    size_t high = hull_.size() - 1;
    while (low < high) {
      const size_t middle = (low + high) / 2;
      const Start& a = hull_[middle];
      const Start& b = hull_[middle + 1];
      if (steeper(bytes - b.before, at_us - b.at_us, bytes - a.before, at_us - a.at_us)) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return hull_[low];
  }

 private:
  static bool turnsLeft(const Start& a, const Start& b, const Start& c) {
    return Wide{b.at_us - a.at_us} * (c.before - a.before) > Wide{c.at_us - a.at_us} * (b.before - a.before);
  }

  std::vector<Start> hull_;
};

// The worst of those that end in one stretch of time.
struct Worst {
  MeteredWindow alone;    // the largest single datagram
  MeteredWindow several;  // the steepest window of two or more
};

MeteredWindow worseOf(Worst worst, int64_t bytes_per_s) {
  auto& [alone, several] = worst;
  if (bytes_per_s == 0) {
    return several.length_us != 0 && steeper(several.bytes, several.length_us, alone.bytes, kSecondUs)
               ? several
               : alone;
  }
  const auto allowed = [&](int64_t length_us) {
    return static_cast<double>(bytes_per_s) * static_cast<double>(length_us) / static_cast<double>(kSecondUs);
  };
  if (alone.bytes > 0) alone.share = std::min(1.0, static_cast<double>(alone.bytes) / allowed(kSecondUs));
  if (several.length_us != 0) {
    several.share = static_cast<double>(several.bytes) / allowed(several.length_us);
    several.within_budget = Wide{several.bytes} * kSecondUs <= Wide{bytes_per_s} * several.length_us;
  }
  if (several.length_us == 0) return alone;
  return !several.within_budget || several.share > alone.share ? several : alone;
}

}  // namespace

WindowMeter::WindowMeter(int64_t bytes_per_s) : bytes_per_s_(bytes_per_s) {
  if (bytes_per_s < 0) {
    throw std::invalid_argument("a budget must be 0 (unlimited) or more bytes/s, got " +
                                std::to_string(bytes_per_s));
  }
}

void WindowMeter::add(int64_t at_us, size_t bytes) { sent_.push_back({at_us, static_cast<int64_t>(bytes)}); }

MeteredWindow WindowMeter::worst() const {
  return worstEndingIn({std::numeric_limits<int64_t>::min()}).front();
}

std::vector<MeteredWindow> WindowMeter::worstEndingIn(const std::vector<int64_t>& from_us) const {
  SHOAL_DEMAND(std::ranges::is_sorted(from_us));
  std::vector<Sent> sent = sent_;
  std::ranges::stable_sort(sent, {}, &Sent::at_us);

  std::vector<Worst> worst(from_us.size());
  size_t stretch = 0;  // one more than that of the present end; 0: before the first
  std::vector<Start> starts;
  Hull hull;         // starts at least 1 s before the present end
  size_t young = 0;  // the first start that is not
  int64_t bytes = 0;
  for (size_t j = 0; j < sent.size(); ++j) {
    const int64_t end_us = sent[j].at_us;
    starts.push_back({end_us, bytes, j});
    bytes += sent[j].bytes;
    for (; end_us - starts[young].at_us >= kSecondUs; ++young) hull.add(starts[young]);
    while (stretch < from_us.size() && from_us[stretch] <= end_us) ++stretch;
    if (stretch == 0) continue;

    auto& [alone, several] = worst[stretch - 1];
    if (sent[j].bytes > alone.bytes) alone = {end_us, kSecondUs, sent[j].bytes, 1, 0, true};
    const auto consider = [&](const Start& start, int64_t length_us) {
      if (start.index == j) return;
      const int64_t inside = bytes - start.before;
      if (several.length_us != 0 && !steeper(inside, length_us, several.bytes, several.length_us)) return;
      several = {start.at_us, length_us, inside, j - start.index + 1, 0, true};
    };
    consider(starts[young], kSecondUs);
    if (!hull.empty()) {
      const Start start = hull.steepestTo(end_us, bytes);
      consider(start, end_us - start.at_us);
    }
  }

  std::vector<MeteredWindow> windows;
  for (const Worst& of_stretch : worst) windows.push_back(worseOf(of_stretch, bytes_per_s_));
  return windows;
}

}  // namespace shoal::comms
