// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/profile.h"

#include <stdexcept>

namespace shoal::robot {

topics::Hyperparameters hyperparametersOf(const std::string& profile) {
  // The published alpha, beta and gamma give a single topic at any count budget up to a hundred visits a
  // cell; the defaults of Hyperparameters are values that work at ours. See docs/paper.md.
  if (profile == "paper") return {};
  if (profile == "best") throw std::invalid_argument("profile \"best\" is not built yet; use \"paper\"");
  throw std::invalid_argument("unknown profile \"" + profile + "\"; profiles: paper");
}

}  // namespace shoal::robot
