// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include "shoal/world/observation.h"

namespace shoal::world {

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
};

}  // namespace shoal::world
