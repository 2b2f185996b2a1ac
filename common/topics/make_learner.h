// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include "shoal/topics/cell_label_hyperparameters.h"
#include "shoal/topics/hyperparameters.h"
#include "shoal/topics/learner.h"
#include "shoal/world/ids.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// The knobs of one kind of learner, and with them which kind: TopicModel labels every word, CellLabelModel
/// every cell.
using LearnerHyperparameters = std::variant<Hyperparameters, CellLabelHyperparameters>;

/// @param groups  Kinds of words in id order; together they tile [0, vocabulary size).
/// @throws std::invalid_argument naming a hyperparameter out of range, or groups that leave gaps.
std::unique_ptr<Learner> makeLearner(const LearnerHyperparameters& hyperparameters,
                                     const std::vector<world::WordGroup>& groups, uint64_t seed,
                                     world::RobotId robot);

/// Equal exactly when kind and every knob are equal (but for hash collisions).
uint64_t fingerprint(const LearnerHyperparameters& hyperparameters);

}  // namespace shoal::topics
