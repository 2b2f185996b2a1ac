// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>

#include <Eigen/Geometry>

#include "shoal/world/ids.h"
#include "shoal/world/pose.h"

namespace shoal::world {

/// A pose as recorders and robots say it; which frame it is of is the user's affair.
struct TimedPose {
  Timestamp time;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();               ///< metres, world
  Eigen::Quaterniond orientation = Eigen::Quaterniond::Identity();  ///< length about 1

  /// True when all is finite and the quaternion's length is within a tenth of 1.
  bool isSane() const;
  Pose pose() const;
};

/// How close in time is close enough, microseconds.
struct PairingOptions {
  int64_t tolerance_us = 20'000;      ///< between an image and its depth, or the nearest pose: TUM's .02 s
  int64_t max_pose_gap_us = 500'000;  ///< between two poses that one in between is interpolated from
};

/// Where something was, and when: poses in any order, asked for at any time.
class PoseTrack {
 public:
  explicit PoseTrack(const PairingOptions& options = {}) : options_(options) {}

  /// Takes a sane pose in. Of two at one time the first stays. Returns false when it changes nothing.
  bool add(const TimedPose& pose);

  /// The pose at a time: the one said for it; else interpolated (position linearly, orientation along the
  /// great circle) between its neighbours when they are at most max_pose_gap apart; else the nearest one
  /// within the tolerance (the earlier on a tie); else nothing. Cost: O(log n).
  std::optional<Pose> at(Timestamp time) const;

  /// True when no pose that comes in order can change at(time).
  bool isSettled(Timestamp time) const { return !poses_.empty() && poses_.rbegin()->first >= time; }

  /// Forgets what lies before a time, but for the last before it.
  void forgetBefore(Timestamp time);

  /// Forgets all but the newest.
  void keepNewest(size_t most);

  size_t size() const { return poses_.size(); }

 private:
  PairingOptions options_;
  std::map<Timestamp, TimedPose> poses_;
};

}  // namespace shoal::world
