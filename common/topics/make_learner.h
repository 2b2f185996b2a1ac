// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <variant>
#include <vector>

#include "shoal/topics/cell_label_hyperparameters.h"
#include "shoal/topics/hyperparameters.h"
#include "shoal/topics/known_topics.h"
#include "shoal/topics/learner.h"
#include "shoal/world/ids.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// The knobs of one kind of learner, and with them which kind: TopicModel labels every word, CellLabelModel
/// every cell.
using LearnerHyperparameters = std::variant<Hyperparameters, CellLabelHyperparameters>;

/// @param groups  Kinds of words in id order; together they tile [0, vocabulary size).
/// @throws std::invalid_argument naming a hyperparameter out of range, groups that leave gaps, or a known
/// topic that is
///         wrong.
std::unique_ptr<Learner> makeLearner(const LearnerHyperparameters& hyperparameters,
                                     const std::vector<world::WordGroup>& groups, uint64_t seed,
                                     world::RobotId robot, const std::vector<KnownTopic>& known = {});

/// The learner that wrote the checkpoint, given what it was made with.
/// @throws std::runtime_error for bytes that are damaged, of another version, or of a learner that was made
///         with something else; std::invalid_argument as makeLearner().
std::unique_ptr<Learner> resumeLearner(const LearnerHyperparameters& hyperparameters,
                                       const std::vector<world::WordGroup>& groups, uint64_t seed,
                                       world::RobotId robot, std::span<const uint8_t> checkpoint,
                                       const std::vector<KnownTopic>& known = {});

/// Equal exactly when kind and every knob are equal (but for hash collisions).
uint64_t fingerprint(const LearnerHyperparameters& hyperparameters);

}  // namespace shoal::topics
