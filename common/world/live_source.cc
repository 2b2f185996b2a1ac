// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/live_source.h"

#include <cmath>
#include <iterator>
#include <stdexcept>
#include <utility>

#include "shoal/demand.h"
#include "shoal/world/flat_floor.h"

namespace shoal::world {
namespace {

constexpr size_t kMaxPoses = 4096;  // half a minute at the rates of inertial units

}  // namespace

LiveSource::LiveSource(LiveOptions options) : options_(std::move(options)), poses_(options_.pairing) {
  if (options_.max_waiting < 1 || options_.max_ready < 1) {
    throw std::invalid_argument("max_waiting and max_ready must be >= 1");
  }
  if (!(options_.altitude_m >= 0.0) || !std::isfinite(options_.altitude_m)) {
    throw std::invalid_argument("altitude must be finite and >= 0 m");
  }
  if (!(options_.min_period_s >= 0.0) || !(options_.min_period_s < 1e9)) {
    throw std::invalid_argument("the least period between pictures must be in [0, 1e9) s");
  }
  start_ = options_.start;
}

void LiveSource::addColor(Timestamp time, cv::Mat color) {
  SHOAL_DEMAND(color.type() == CV_8UC3);
  if (closed_) return;
  const Intrinsics& camera = options_.camera.intrinsics;
  if (color.cols != camera.width || color.rows != camera.height) {
    ++left_out_["pictures not of the camera's size"];
  } else if (last_emitted_ && time <= *last_emitted_) {
    ++left_out_["pictures that came after later ones had been taken"];
  } else if (waiting_.contains(time)) {
    ++left_out_["pictures of a time that was there"];
  } else if (last_taken_in_ && time > *last_taken_in_ &&
             static_cast<double>(time.us - last_taken_in_->us) < options_.min_period_s * 1e6) {
    return;  // passed over as asked
  } else {
    if (!last_taken_in_ || time > *last_taken_in_) last_taken_in_ = time;
    waiting_.emplace(time, std::move(color));
    settle();
  }
}

void LiveSource::addDepth(Timestamp time, cv::Mat depth_m) {
  SHOAL_DEMAND(depth_m.type() == CV_32FC1);
  if (closed_) return;
  const Intrinsics& camera = options_.camera.intrinsics;
  if (depth_m.cols != camera.width || depth_m.rows != camera.height) {
    ++left_out_["depth pictures not of the camera's size"];
    return;
  }
  heard_depth_ = true;
  depths_.emplace(time, std::move(depth_m));
  while (depths_.size() > 2 * options_.max_waiting + 2) depths_.erase(depths_.begin());
  settle();
}

void LiveSource::addPose(const TimedPose& world_from_body) {
  if (closed_) return;
  poses_.add(world_from_body);
  poses_.keepNewest(kMaxPoses);
  settle();
}

void LiveSource::close() {
  closed_ = true;
  settle();
}

bool LiveSource::hasEnded() const {
  const bool enough = options_.max_observations > 0 && taken_ >= options_.max_observations;
  return enough || (closed_ && ready_.empty() && waiting_.empty());
}

std::optional<Observation> LiveSource::next() {
  if (ready_.empty() || hasEnded()) return std::nullopt;
  Observation seen = std::move(ready_.front());
  ready_.pop_front();
  seen.number = taken_++;
  return seen;
}

std::optional<int32_t> LiveSource::numObservations() const {
  return options_.max_observations > 0 ? std::optional(options_.max_observations) : std::nullopt;
}

std::string LiveSource::troubles() const {
  std::string text;
  for (const auto& [what, count] : left_out_) {
    text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  }
  return text;
}

void LiveSource::settle() {
  while (!waiting_.empty()) {
    const bool now = closed_ || waiting_.size() > options_.max_waiting;
    if (!settleEarliest(now)) break;
  }
  forgetThePast();
}

// False when the earliest picture has to wait for what may still come.
bool LiveSource::settleEarliest(bool now) {
  const Timestamp time = waiting_.begin()->first;
  const auto world_from_body = poses_.at(time);
  const bool pose_is_final = world_from_body && poses_.isSettled(time);
  const cv::Mat* depth_m = depthNear(time);
  const bool has_floor = options_.altitude_m > 0.0;
  const bool depth_is_final = (has_floor && !heard_depth_) || (depth_m != nullptr && isDepthSettled(time));
  if (!now && !(pose_is_final && depth_is_final)) return false;
  cv::Mat color = std::move(waiting_.begin()->second);
  waiting_.erase(waiting_.begin());
  if (!world_from_body) {
    ++left_out_["pictures without a pose"];
  } else if (depth_m == nullptr && !has_floor) {
    ++left_out_["pictures without depth"];
  } else {
    emit(time, std::move(color), *world_from_body, depth_m);
  }
  return true;
}

// The depth picture nearest in time within the tolerance, the earlier on a tie.
const cv::Mat* LiveSource::depthNear(Timestamp time) const {
  const auto after = depths_.lower_bound(time);
  const cv::Mat* best = nullptr;
  int64_t best_us = options_.pairing.tolerance_us;
  if (after != depths_.end() && after->first.us - time.us <= best_us) {
    best = &after->second;
    best_us = after->first.us - time.us;
  }
  if (after != depths_.begin() && time.us - std::prev(after)->first.us <= best_us)
    best = &std::prev(after)->second;
  return best;
}

// True when no depth picture that comes in order can be nearer.
bool LiveSource::isDepthSettled(Timestamp time) const {
  return !depths_.empty() && depths_.rbegin()->first >= time;
}

void LiveSource::emit(Timestamp time, cv::Mat color, const Pose& world_from_body, const cv::Mat* depth_m) {
  if (!start_) start_ = time;
  last_emitted_ = time;
  if (time < *start_) {
    ++left_out_["pictures from before the mission's start"];
    return;
  }
  Observation seen;
  seen.time.us = time.us - start_->us;
  seen.color = std::move(color);
  seen.intrinsics = options_.camera.intrinsics;
  seen.world_from_camera = world_from_body * options_.camera.body_from_camera;
  seen.depth_m = depth_m != nullptr
                     ? *depth_m
                     : flatFloorDepth(seen.intrinsics, seen.world_from_camera, options_.altitude_m);
  ready_.push_back(std::move(seen));
  if (ready_.size() > options_.max_ready) {
    ready_.pop_front();
    ++left_out_["observations, for they came faster than they were learnt from"];
  }
}

// Pictures still to come out are later than the last one that did.
void LiveSource::forgetThePast() {
  if (!last_emitted_) return;
  depths_.erase(depths_.begin(), depths_.lower_bound({last_emitted_->us - options_.pairing.tolerance_us}));
  poses_.forgetBefore(*last_emitted_);
}

}  // namespace shoal::world
