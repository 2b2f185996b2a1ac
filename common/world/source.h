// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "shoal/world/observation.h"

namespace shoal::world {

/// What a vehicle says of itself.
struct Vehicle {
  std::optional<int32_t> battery_percent;  ///< in [0, 100]
  std::optional<double> depth_m;           ///< below the surface, in [0, 20000]
};

/// A stream of observations, in time order: flown over a world, recorded, or live.
class ObservationSource {
 public:
  virtual ~ObservationSource() = default;

  /// The next observation, or nothing at the end of the stream.
  virtual std::optional<Observation> next() = 0;

  /// How many observations the whole stream has, when that is known.
  virtual std::optional<int32_t> numObservations() const = 0;

  /// Whether next() answers at once. A live source first takes in what has come.
  virtual bool ready() { return true; }

  /// What was left out so far and why, for people; empty when nothing was.
  virtual std::string troubles() const { return {}; }

  /// The latest that is known of the vehicle that carries the camera.
  virtual Vehicle vehicle() const { return {}; }
};

}  // namespace shoal::world
