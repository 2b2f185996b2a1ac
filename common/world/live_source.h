// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>

#include "shoal/world/camera_file.h"
#include "shoal/world/pose_track.h"
#include "shoal/world/source.h"

namespace shoal::world {

struct LiveOptions {
  Camera camera;            ///< its intrinsics and mounting
  double altitude_m = 0.0;  ///< above a flat floor, for robots without depth; 0 = depth is needed
  PairingOptions pairing;
  /// Pictures that wait for their pose and depth, >= 1; when one more comes, the earliest makes do with what
  /// is there, or is left out.
  size_t max_waiting = 8;
  /// Observations that wait to be taken, >= 1; when one more is made, the earliest is left out: whoever
  /// cannot keep up sees the present, with gaps.
  size_t max_ready = 16;
  double min_period_s = 0.0;     ///< pictures closer to the last one taken in are passed over
  int32_t max_observations = 0;  ///< after so many the stream ends; 0 = never
  std::optional<Timestamp>
      start;  ///< the robot's time that is mission time 0; default: the first observation's
};

/// Makes observations of what a robot's camera, depth camera and localisation say, each in its own time:
/// with jitter, gaps, late and in any order. Pictures come out in the order of their times, each with the
/// pose and the depth of its time, as in a recording: see readRecording(). What cannot be paired is left out
/// and counted. Only the times in what comes in decide, never when it came; so a stream that lost nothing
/// gives the observations that its recording gives.
///
/// Memory: bounded by max_waiting and max_ready pictures.
class LiveSource final : public ObservationSource {
 public:
  /// @throws std::invalid_argument naming the option that is out of range.
  explicit LiveSource(LiveOptions options);

  // What came, with the robot's own times, in [0, 2^62) us.

  /// @param color  CV_8UC3, BGR.
  void addColor(Timestamp time, cv::Mat color);
  /// @param depth_m  CV_32FC1, metres; see Observation.
  void addDepth(Timestamp time, cv::Mat depth_m);
  /// @param world_from_body  sane.
  void addPose(const TimedPose& world_from_body);
  /// Nothing more will come: what waits makes do with what is there.
  void close();

  /// True when next() has an observation, or knows that there will be none.
  bool ready() override { return !ready_.empty() || hasEnded(); }
  /// Nothing unless ready().
  std::optional<Observation> next() override;
  std::optional<int32_t> numObservations() const override;
  std::string troubles() const override;

  bool hasEnded() const;

 private:
  void settle();
  bool settleEarliest(bool now);
  const cv::Mat* depthNear(Timestamp time) const;
  bool isDepthSettled(Timestamp time) const;
  void emit(Timestamp time, cv::Mat color, const Pose& world_from_body, const cv::Mat* depth_m);
  void forgetThePast();

  const LiveOptions options_;
  PoseTrack poses_;
  std::map<Timestamp, cv::Mat> waiting_;  // colour
  std::map<Timestamp, cv::Mat> depths_;
  std::deque<Observation> ready_;
  std::map<std::string, int> left_out_;
  std::optional<Timestamp> start_, last_emitted_, last_taken_in_;
  bool heard_depth_ = false, closed_ = false;
  int32_t taken_ = 0;
};

}  // namespace shoal::world
