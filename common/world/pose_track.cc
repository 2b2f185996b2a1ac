// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/pose_track.h"

#include <cmath>
#include <iterator>

#include "shoal/demand.h"

namespace shoal::world {

bool TimedPose::isSane() const {
  return position.allFinite() && orientation.coeffs().allFinite() && std::abs(orientation.norm() - 1.0) < 0.1;
}

Pose TimedPose::pose() const {
  Pose pose = Pose::Identity();
  pose.translation() = position;
  pose.linear() = orientation.normalized().toRotationMatrix();
  return pose;
}

bool PoseTrack::add(const TimedPose& pose) {
  SHOAL_DEMAND(pose.isSane());
  return poses_.emplace(pose.time, pose).second;
}

std::optional<Pose> PoseTrack::at(Timestamp time) const {
  const auto after = poses_.lower_bound(time);
  if (after != poses_.end() && after->first == time) return after->second.pose();
  const bool has_before = after != poses_.begin(), has_after = after != poses_.end();
  const auto before = has_before ? std::prev(after) : after;
  if (has_before && has_after && after->first.us - before->first.us <= options_.max_pose_gap_us) {
    const double share = static_cast<double>(time.us - before->first.us) /
                         static_cast<double>(after->first.us - before->first.us);
    const TimedPose &a = before->second, &b = after->second;
    return TimedPose{time, a.position + share * (b.position - a.position),
                     a.orientation.normalized().slerp(share, b.orientation.normalized())}
        .pose();
  }
  const auto distance = [&](auto pose) { return std::abs(pose->first.us - time.us); };
  if (has_before && distance(before) <= options_.tolerance_us &&
      (!has_after || distance(before) <= distance(after))) {
    return before->second.pose();
  }
  if (has_after && distance(after) <= options_.tolerance_us) return after->second.pose();
  return std::nullopt;
}

void PoseTrack::forgetBefore(Timestamp time) {
  auto last_before = poses_.lower_bound(time);
  if (last_before == poses_.begin()) return;
  poses_.erase(poses_.begin(), std::prev(last_before));
}

void PoseTrack::keepNewest(size_t most) {
  while (poses_.size() > most) poses_.erase(poses_.begin());
}

}  // namespace shoal::world
