// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/profile.h"

#include <stdexcept>

namespace shoal::robot {

topics::LearnerHyperparameters hyperparametersOf(const std::string& profile) {
  // The published alpha, beta and gamma give a single topic at any count budget up to a hundred visits a
  // cell (docs/paper.md). These were found at commit 4525be633e20 by
  //     operator_console tune --out DIR
  if (profile == "paper") {
    topics::Hyperparameters paper;
    paper.alpha = 0.323;
    paper.beta = 0.0593;
    return paper;
  }
  if (profile == "best") return topics::CellLabelHyperparameters{};
  throw std::invalid_argument("unknown profile \"" + profile + "\"; profiles: best, paper");
}

}  // namespace shoal::robot
