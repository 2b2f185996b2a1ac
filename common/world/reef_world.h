// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "shoal/world/reef_camera.h"
#include "shoal/world/reef_scene.h"
#include "shoal/world/world.h"

namespace shoal::world {

/// A procedural reef under water: relief, corals and rocks that hide each other, exact labels, light that
/// fades with distance, and the noise of a sensor. Truth is in the labels of rendered frames, for the surface
/// is not flat.
class ReefWorld final : public World {
 public:
  /// @param seed  another place of the same kind.
  ReefWorld(ReefStyle style, uint64_t seed);

  const std::string& name() const override { return scene_.style().name; }
  Extent extent() const override { return {0.0, -ReefScene::kSide, ReefScene::kSide, 0.0}; }
  double metresPerPixel() const override { return 0.04; }
  double defaultCellSize() const override { return 0.8; }
  const std::vector<TruthClass>& classes() const override { return classes_; }

  /// Pixels that miss the reef's square have no depth, are black and unlabelled. What is within 5 cm of the
  /// camera, or small and more than 60 m away, is not seen. Cost: about 5 ms for 320 x 240 pixels 8 m up.
  Observation render(const Intrinsics& intrinsics, const Pose& world_from_camera) const override;

  /// A map: what lies under each point of a rectangle, straight from above, as if seen through the water from
  /// 8 m over Z = 0, without lens or noise. Depths are heights, metres; truth for flat cells.
  /// @param area  inside the reef, at most 50 m a side.
  /// @throws std::invalid_argument when it is not, or metres_per_pixel is not finite and > 0.
  Observation fromAbove(const Extent& area, double metres_per_pixel) const;

  std::optional<uint8_t> truthOfSquare(const Grid&, const CellIndex&) const override { return std::nullopt; }
  bool hasFlatTruth() const override { return false; }

  const ReefScene& scene() const { return scene_; }

 private:
  ReefScene scene_;
  WaterColumn water_;
  std::vector<TruthClass> classes_;
};

}  // namespace shoal::world
