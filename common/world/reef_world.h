// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <string>
#include <vector>

#include "shoal/world/reef_surface.h"
#include "shoal/world/world.h"

namespace shoal::world {

/// A procedural reef under water: relief, corals and rocks, exact labels, light that fades with distance, and
/// the noise of a sensor. Truth is in the labels of rendered frames, for the surface is not flat.
class ReefWorld final : public World {
 public:
  /// @param seed  another place of the same kind.
  ReefWorld(ReefStyle style, uint64_t seed);

  const std::string& name() const override { return surface_.style().name; }
  Extent extent() const override { return {0.0, -ReefSurface::kSide, ReefSurface::kSide, 0.0}; }
  double metresPerPixel() const override { return 0.04; }
  double defaultCellSize() const override { return 0.8; }
  const std::vector<TruthClass>& classes() const override { return classes_; }

  /// Pixels that miss the reef's square have no depth, are black and unlabelled. Cost: about 150 ns a pixel.
  Observation render(const Intrinsics& intrinsics, const Pose& world_from_camera) const override;

  std::optional<uint8_t> truthOfSquare(const Grid&, const CellIndex&) const override { return std::nullopt; }
  bool hasFlatTruth() const override { return false; }

  const ReefSurface& surface() const { return surface_; }

 private:
  ReefSurface surface_;
  std::vector<TruthClass> classes_;
};

}  // namespace shoal::world
