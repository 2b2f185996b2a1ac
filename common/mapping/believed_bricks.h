// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "shoal/mapping/local_belief.h"

namespace shoal::mapping {

/// Coordinates of a brick: brickOf().
using Brick = std::array<int32_t, 3>;

/// The cells of a belief, brick by brick, for those who do not want to look at all of them.
class BelievedBricks {
 public:
  virtual ~BelievedBricks() = default;

  /// Ascending by cell; none for a brick that is not there. Costs what the brick holds.
  virtual std::vector<BelievedCell> cellsOf(const Brick& brick) const = 0;

  /// The first brick after this one, ascending, or of all; nothing when there is none.
  virtual std::optional<Brick> after(const std::optional<Brick>& brick) const = 0;

 protected:
  BelievedBricks() = default;
  BelievedBricks(const BelievedBricks&) = default;
  BelievedBricks(BelievedBricks&&) = default;
  BelievedBricks& operator=(const BelievedBricks&) = default;
  BelievedBricks& operator=(BelievedBricks&&) = default;
};

}  // namespace shoal::mapping
