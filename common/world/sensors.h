// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>

#include "shoal/world/source.h"

namespace shoal::world {

/// How far a robot's camera, depth sensor and navigation are from perfect. All 0: perfect.
struct SensorOptions {
  /// Each robot has one brightness for the whole mission, log-uniform in [1 / (1 + exposure), 1 + exposure];
  /// in [0, 9]. What it makes brighter than white is white.
  double exposure = 0.0;
  /// Each robot multiplies each colour channel by its own factor, uniform in [1 - cast, 1 + cast]; in [0,
  /// 0.99].
  double color_cast = 0.0;
  /// Dead reckoning: over a stretch of s metres flown, the standard deviation of the error that it adds in x
  /// and in y is pose_drift x sqrt(s) metres, and in heading 0.02 x pose_drift x sqrt(s) radians, which turns
  /// the way flown thereafter as well. Metres per square root of a metre, in [0, 10]; 0.05 is 1.6 m (and 1.8
  /// degrees) in a kilometre.
  double pose_drift = 0.0;
  /// Standard deviation of a pixel's depth over that depth, in [0, 0.3]: the further, the noisier.
  double depth_noise = 0.0;
  /// Part of a frame's depth that is missing in ragged patches, in the mean over frames (half to one and a
  /// half times as much in one frame), in [0, 0.6]. When > 0, depth is missing as well where it jumps by more
  /// than 3 % from a pixel to the next: stereo and structured light see edges from one side only.
  double depth_holes = 0.0;

  bool operator==(const SensorOptions&) const = default;
};

/// What `source` gives, as seen by the sensors of one robot. Labels stay as they are: truth knows no sensors.
/// What is done to an observation is a pure function of (seed, robot, its number) and, for drift, of the way
/// flown before it. Perfect sensors give the source back. Cost: 1 to 3 ms a frame of 320 x 240.
/// @param source  not null.
/// @param robot  any number; robots of other numbers have other sensors.
/// @throws std::invalid_argument naming the option that is out of range.
std::unique_ptr<ObservationSource> withSensors(std::unique_ptr<ObservationSource> source,
                                               const SensorOptions& options, int robot, uint64_t seed);

/// @throws std::invalid_argument naming the option that is out of range.
void checkSensors(const SensorOptions& options);

}  // namespace shoal::world
