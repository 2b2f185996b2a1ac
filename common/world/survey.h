// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "shoal/world/sensors.h"
#include "shoal/world/world.h"

namespace shoal::world {

/// How a team flies over a world. Everything here decides what is seen.
struct SurveyOptions {
  int num_robots = 1;           ///< >= 1; the extent is cut into that many rectangles on cell borders
  int32_t observations = 0;     ///< per robot; 0 = as many as cover the share at 30 % overlap
  double cell_size_m = 0.0;     ///< 0 = the world's default
  double altitude_m = 0.0;      ///< above Z = 0; 0 = native resolution: fx x metres per pixel
  double frame_period_s = 1.0;  ///< frame n is at n x this
  Intrinsics intrinsics;
  SensorOptions sensors;  ///< what Place::source() makes of what is seen; paths and truth know nothing of it
};

/// The rectangles that the robots of a team cover, in robot order: a near-square arrangement of rows, cut
/// on cell borders, that together tile the extent.
std::vector<Extent> shares(const Extent& extent, int num_robots, const Grid& grid);

/// Camera poses of a lawnmower path that spreads `observations` evenly over a share.
std::vector<Pose> lawnmower(const Extent& share, int32_t observations, double altitude_m,
                            const Intrinsics& intrinsics);

/// The fraction of the share's area that at least one footprint on Z = 0 covers.
double coverage(const Extent& share, const std::vector<Pose>& path, const Intrinsics& intrinsics);

/// One robot's path (robot < num_robots), or the whole team's one share after the other when `single`.
std::vector<Pose> surveyPath(const World& world, const SurveyOptions& options, int robot,
                             bool single = false);

/// Renders a path frame by frame. `world` must outlive the source.
std::unique_ptr<ObservationSource> makeSurveySource(const World& world, std::vector<Pose> path,
                                                    const Intrinsics& intrinsics, double frame_period_s);

}  // namespace shoal::world
