// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shoal/world/camera_file.h"
#include "shoal/world/grid.h"
#include "shoal/world/source.h"
#include "shoal/world/survey.h"
#include "shoal/world/world.h"

namespace shoal::world {

/// Where a mission takes place: gives each robot of a team its observations, and knows the truth for scores.
/// Either a World that a camera is flown over, or what the cameras of real robots have recorded.
class Place {
 public:
  virtual ~Place() = default;

  virtual const std::string& name() const = 0;                 ///< e.g. "dubai_tile5", "reef:sparse"
  virtual const std::vector<TruthClass>& classes() const = 0;  ///< empty when nothing is labelled

  /// How many robots may take part: as many as were recorded, or kMaxTeam over a world.
  virtual int maxRobots() const = 0;
  static constexpr int kMaxTeam = 10000;

  /// True for recordings: paths, times and the number of robots are given, not planned.
  virtual bool isRecorded() const = 0;

  /// The options with what the caller left 0 filled in: the cell size and, over a world, the altitude of
  /// native resolution. Recordings have at most as many observations as their longest robot. What is filled
  /// in does not depend on num_robots.
  /// @throws std::invalid_argument naming the option that cannot be had here and what would be right.
  virtual SurveyOptions completed(SurveyOptions options) const = 0;

  /// What one robot sees through its sensors (robot < num_robots), or everybody's frames, one robot after the
  /// other, when `single`. Options need not be completed(). Any number of sources may be made and read at
  /// once, from any thread; the place must outlive them.
  /// @throws std::invalid_argument as completed(), and for a robot that is not of the team.
  virtual std::unique_ptr<ObservationSource> source(const SurveyOptions& options, int robot,
                                                    bool single = false) const = 0;

  /// The area to be covered; nothing for recordings, which cover what they cover.
  virtual std::optional<Extent> extent() const = 0;

  /// As World::truthOfSquare() and World::hasFlatTruth().
  virtual std::optional<uint8_t> truthOfSquare(const Grid& grid, const CellIndex& cell) const = 0;
  virtual bool hasFlatTruth() const = 0;
};

/// Opens what openWorld() opens, or a recording: an RGB-D folder in TUM layout, or a folder of folders
/// robot0, robot1, ... of them, robot n's each: docs/cameras.md.
/// @param camera  for recordings: says instead of each camera.json, or beside it, what it says. A world is
///                flown with the intrinsics of SurveyOptions.
/// @throws std::invalid_argument naming what is missing or malformed and what would be right.
std::unique_ptr<Place> openPlace(const std::string& spec, uint64_t seed = 1,
                                 const std::optional<Camera>& camera = {});

/// A world as a place: surveyPath() flown with makeSurveySource().
/// @param seed  of the sensors' faults.
std::unique_ptr<Place> makePlace(std::unique_ptr<World> world, uint64_t seed = 1);

}  // namespace shoal::world
