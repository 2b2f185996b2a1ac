// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/make_learner.h"

#include <bit>
#include <initializer_list>

#include "shoal/random.h"
#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/topic_model.h"

namespace shoal::topics {
namespace {

uint64_t hashOf(std::initializer_list<double> values) {
  uint64_t hash = 0;
  for (const double value : values) hash = hashCombine(hash, std::bit_cast<uint64_t>(value));
  return hash;
}

// Counts below 2^53 are exact as double.
uint64_t hashOf(const Hyperparameters& h) {
  return hashOf({static_cast<double>(h.max_topics), h.alpha, h.beta, h.gamma, h.neighbor_weight, h.tau,
                 h.local_rate, static_cast<double>(h.resamples_per_observation)});
}

uint64_t hashOf(const CellLabelHyperparameters& h) {
  return hashOf({static_cast<double>(h.max_topics), static_cast<double>(h.cells_per_topic), h.evidence,
                 h.beta, h.coupling, h.tau, h.local_rate, h.twin_similarity, h.visits_per_cell});
}

int32_t sizeOf(const std::vector<world::WordGroup>& groups) {
  return groups.empty() ? 0 : groups.back().first + groups.back().size;
}

}  // namespace

void Learner::lookAgain(const TeamTopics&, const std::function<void()>&) {
  throw std::logic_error("this kind of learner does not look again");
}

std::unique_ptr<Learner> makeLearner(const LearnerHyperparameters& hyperparameters,
                                     const std::vector<world::WordGroup>& groups, uint64_t seed,
                                     world::RobotId robot, const std::vector<KnownTopic>& known) {
  if (const auto* cells = std::get_if<CellLabelHyperparameters>(&hyperparameters)) {
    return std::make_unique<CellLabelModel>(*cells, groups, seed, robot, known);
  }
  return std::make_unique<TopicModel>(std::get<Hyperparameters>(hyperparameters), sizeOf(groups), seed, robot,
                                      known);
}

std::unique_ptr<Learner> resumeLearner(const LearnerHyperparameters& hyperparameters,
                                       const std::vector<world::WordGroup>& groups, uint64_t seed,
                                       world::RobotId robot, std::span<const uint8_t> checkpoint,
                                       const std::vector<KnownTopic>& known) {
  if (const auto* cells = std::get_if<CellLabelHyperparameters>(&hyperparameters)) {
    return std::make_unique<CellLabelModel>(
        CellLabelModel::resumed(*cells, groups, seed, robot, checkpoint, known));
  }
  return std::make_unique<TopicModel>(TopicModel::resumed(std::get<Hyperparameters>(hyperparameters),
                                                          sizeOf(groups), seed, robot, checkpoint, known));
}

uint64_t fingerprint(const LearnerHyperparameters& hyperparameters) {
  return hashCombine(hyperparameters.index(),
                     std::visit([](const auto& h) { return hashOf(h); }, hyperparameters));
}

}  // namespace shoal::topics
