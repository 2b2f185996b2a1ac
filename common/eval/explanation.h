// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "shoal/eval/evaluation.h"
#include "shoal/matching/matcher.h"
#include "shoal/world/ids.h"

namespace shoal::eval {

/// Why a fused map scores as it does.
struct Explanation {
  struct Label {
    world::GlobalLabel label{};
    int64_t cells = 0;
    std::vector<int64_t> cells_of_class;  ///< one entry a class
    int majority = -1;                    ///< the class of most of its cells; -1 without truth
  };
  struct Robot {
    world::RobotId robot{};
    int topics = 0;     ///< that label a cell of the fused map
    int64_t cells = 0;  ///< of the fused map
    double purity = 0;  ///< share of them whose topic has their class as majority
    double ami = 0;     ///< of its own labels on its own cells
  };
  struct Confusion {
    int truth = 0, taken_for = 0;  ///< classes: cells of `truth` under labels whose majority is `taken_for`
    int64_t cells = 0;
  };
  Score fused;                        ///< as the matcher scores
  Score oracle;                       ///< each topic given the class of most of its cells
  double purity = 0;                  ///< of all robots' topics
  double label_purity = 0;            ///< of the fused labels
  std::vector<Label> labels;          ///< largest first
  std::vector<Robot> robots;          ///< ascending
  std::vector<Confusion> confusions;  ///< most cells first
};

/// @throws std::invalid_argument as matching::match().
Explanation explain(const Run& run, const matching::MatcherOptions& matcher, const TruthOfCell& truth);

}  // namespace shoal::eval
