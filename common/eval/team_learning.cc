// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/team_learning.h"

#include <algorithm>
#include <map>
#include <utility>

#include "shoal/demand.h"
#include "shoal/eval/piece_cost.h"
#include "shoal/eval/topic_tally.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/stacked_topics.h"
#include "shoal/robot/explorer.h"
#include "shoal/robot/team_topics.h"
#include "shoal/wire/limits.h"

namespace shoal::eval {
namespace {

constexpr size_t kPublishEvery = 5;  // as robot_agent

robot::Explorer explorer(world::RobotId robot, double cell_size_m, const LearningOptions& options) {
  return robot::Explorer({.robot = robot,
                          .profile = options.profile,
                          .seed = options.seed,
                          .cell_size_m = cell_size_m,
                          .hyperparameters = options.hyperparameters});
}

}  // namespace

std::vector<mapping::LocalBelief> learn(const std::vector<world::WordsInCells>& images, world::RobotId robot,
                                        double cell_size_m, const LearningOptions& options,
                                        std::span<const int32_t> checkpoints,
                                        std::vector<uint8_t>* const last) {
  robot::Explorer mind = explorer(robot, cell_size_m, options);
  std::vector<mapping::LocalBelief> beliefs;
  size_t learnt = 0;
  for (const int32_t checkpoint : checkpoints) {
    for (; learnt < std::min(images.size(), static_cast<size_t>(checkpoint)); ++learnt)
      mind.learn(images[learnt]);
    beliefs.push_back(mind.belief());
  }
  if (last != nullptr) *last = mind.checkpoint();
  return beliefs;
}

std::vector<mapping::LocalBelief> lookAgain(std::span<const Landed* const> team, double cell_size_m,
                                            const LearningOptions& options) {
  std::vector<mapping::LocalBelief> beliefs;
  for (const Landed* robot : team) beliefs.push_back(robot->belief);
  if (team.size() < 2 || !options.looks_again) return beliefs;
  mapping::BeliefStore heard;
  for (const mapping::LocalBelief& belief : beliefs)
    for (const mapping::Piece& piece : mapping::wholePieces(belief)) heard.apply(piece);
  for (size_t i = 0; i < team.size(); ++i) {
    robot::Explorer mind = explorer(beliefs[i].robot, cell_size_m, options);
    if (!mind.canLookAgain()) break;
    mind.restore(team[i]->mind);
    mind.lookAgain(robot::teamTopics(heard, beliefs[i].robot, matching::usualMatcher()));
    beliefs[i] = mind.belief();
  }
  return beliefs;
}

SentBytes bytesSent(const std::vector<world::WordsInCells>& images, world::RobotId robot, double cell_size_m,
                    const LearningOptions& options) {
  robot::Explorer mind = explorer(robot, cell_size_m, options);
  mapping::BeliefChanges changes;
  SentBytes sent;
  for (size_t i = 0; i < images.size(); ++i) {
    mind.learn(images[i]);
    if ((i + 1) % kPublishEvery != 0 && i + 1 < images.size()) continue;
    for (const mapping::Piece& whole : changes.update(mind.belief())) {
      int64_t& bytes = std::holds_alternative<mapping::TopicPart>(whole.content) ? sent.topics : sent.map;
      const PieceCost cost = costOf(whole);
      bytes += cost.bytes;
      sent.datagrams += cost.datagrams;
    }
  }
  return sent;
}

Stacked stackTeam(std::vector<mapping::LocalBelief> team) {
  mapping::BeliefStore store;
  for (size_t i = 0; i < team.size(); ++i) {
    team[i].robot = world::RobotId{static_cast<int32_t>(i)};
    for (const mapping::Piece& piece : mapping::wholePieces(team[i])) store.apply(piece);
  }
  return {mapping::stack(store).descriptors, std::move(team)};
}

std::vector<int> labelsOf(const Stacked& team, const TeamTally& tally,
                          const matching::MatcherOptions& matcher) {
  const matching::Clustering clustering = matching::match(team.descriptors, matcher);
  std::map<std::pair<int32_t, int32_t>, int> label;
  size_t vertex = 0;
  for (size_t robot = 0; robot < team.descriptors.robots.size(); ++robot) {
    for (const matching::Descriptor& topic : team.descriptors.robots[robot]) {
      label.emplace(std::pair(static_cast<int32_t>(robot), topic.slot), clustering.label[vertex++]);
    }
  }
  std::vector<int> labels;
  int alone = clustering.num_labels + clustering.universe;
  for (const TopicTally& topic : tally.topics) {
    const auto known = label.find({number(topic.robot), number(topic.topic)});
    labels.push_back(known == label.end() ? alone++ : known->second);
  }
  return labels;
}

Score scoreMatcher(const Stacked& team, const TeamTally& tally, const matching::MatcherOptions& matcher) {
  return score(tally, labelsOf(team, tally, matcher));
}

}  // namespace shoal::eval
