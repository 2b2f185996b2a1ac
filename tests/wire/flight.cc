// SPDX-License-Identifier: BSD-3-Clause
#include "flight.h"

#include <limits>
#include <span>

#include "shoal/eval/team_learning.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/fusion.h"
#include "shoal/world/place.h"

namespace shoal::wire {

eval::TeamWords look(const std::string& world, int32_t images, double cell_size_m) {
  const auto place = world::openPlace(world);
  world::SurveyOptions survey;
  survey.num_robots = kFlyingRobots;
  survey.observations = images;
  survey.cell_size_m = cell_size_m;
  return eval::lookAround(*place, 1, survey, "best", {});
}

Knobs usualKnobs() { return std::get<Knobs>(robot::hyperparametersOf("best")); }

Team learn(const eval::TeamWords& words, uint64_t seed, const Knobs& knobs) {
  constexpr int32_t kAll = std::numeric_limits<int32_t>::max();
  const eval::LearningOptions options{.profile = "best", .seed = seed, .hyperparameters = knobs};
  Team team;
  for (size_t i = 0; i < words.robots.size(); ++i) {
    const world::RobotId robot{static_cast<int32_t>(i)};
    team.push_back(
        eval::learn(words.robots[i], robot, words.cell_size_m, options, std::span(&kAll, 1)).front());
  }
  return team;
}

mapping::GlobalMap fused(const Team& team) {
  mapping::BeliefStore store;
  for (const mapping::LocalBelief& belief : team)
    for (const mapping::Piece& piece : mapping::wholePieces(belief)) store.apply(piece);
  return mapping::fuse(store, {.matcher = "shoal", .similarity = matching::usualSimilarity("shoal")});
}

}  // namespace shoal::wire
