// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shoal/world/grid.h"
#include "shoal/world/observation.h"
#include "shoal/world/source.h"

namespace shoal::world {

/// A ground-truth class, for scores and pictures; robots never see it.
struct TruthClass {
  int id = 0;  ///< value in label images
  std::string name;
  std::array<uint8_t, 3> rgb{};
};

/// A rectangle on the ground, metres, world frame.
struct Extent {
  double min_x = 0, min_y = 0, max_x = 0, max_y = 0;
};

/// A place that robots can fly over: renders what a camera at a pose sees.
class World {
 public:
  virtual ~World() = default;

  virtual const std::string& name() const = 0;  ///< e.g. "dubai_tile5", "reef:sparse"
  virtual Extent extent() const = 0;
  virtual double metresPerPixel() const = 0;                   ///< native resolution on the ground
  virtual double defaultCellSize() const = 0;                  ///< metres
  virtual const std::vector<TruthClass>& classes() const = 0;  ///< empty when nothing is labelled

  /// What a camera sees from a pose: color, depth_m, labels, intrinsics and pose of an Observation;
  /// number and time are the caller's. Pure: the same pose gives the same pixels.
  /// @throws std::invalid_argument as checkCamera().
  virtual Observation render(const Intrinsics& intrinsics, const Pose& world_from_camera) const = 0;

  /// Truth of the cells straight from the world, where the world is a flat labelled picture: the class of
  /// the majority of labelled pixels inside the cell's square (ties to the lowest id), 255 when fewer than
  /// half of its pixels are labelled or it lies outside. Nothing where truth needs projected frames.
  virtual std::optional<uint8_t> truthOfSquare(const Grid& grid, const CellIndex& cell) const = 0;

  /// True when truthOfSquare() answers; false when truth comes from the labels of rendered frames.
  virtual bool hasFlatTruth() const = 0;
};

/// @throws std::invalid_argument unless the image has pixels (sides in [1, 16384]), the focal lengths are
///         finite and > 0, and the principal point and the pose are finite.
void checkCamera(const Intrinsics& intrinsics, const Pose& world_from_camera);

/// Opens `reef:sparse`, `reef:varied`, `reef:tuning` or a world folder (world.json).
/// @param seed  varies a procedural reef; ignored by folders.
/// @throws std::invalid_argument naming what is missing or malformed and what would be right.
std::unique_ptr<World> openWorld(const std::string& spec, uint64_t seed = 1);

}  // namespace shoal::world
