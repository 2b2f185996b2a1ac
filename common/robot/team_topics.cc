// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/team_topics.h"

#include <map>
#include <utility>

#include "shoal/mapping/judgement.h"
#include "shoal/mapping/library.h"
#include "shoal/mapping/stacked_topics.h"
#include "shoal/mapping/topic_matching.h"

namespace shoal::robot {
namespace {

// No honest robot tells more.
bool isTooLarge(const std::vector<world::WordCount>& words) {
  int64_t total = 0;
  for (const world::WordCount& w : words) total += w.count;
  return total > topics::TeamTopics::kMostWords;
}

}  // namespace

topics::TeamTopics teamTopics(const mapping::BeliefStore& heard, world::RobotId self,
                              const matching::MatcherOptions& matcher) {
  const mapping::Judgement judgement = mapping::judge(heard);
  std::map<std::pair<world::RobotId, world::TopicId>, int64_t> cells;  // every topic takes part
  heard.visitTopics([&](const mapping::Piece& piece) {
    cells[{piece.key.robot, world::TopicId{piece.key.index[0]}}] = 1;
  });
  const mapping::StackedTopics stacked = mapping::stack(heard, judgement.excluded, cells);
  const matching::Clustering clustering = mapping::matchTopics(stacked, matcher, judgement);
  topics::TeamTopics team;
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    const mapping::HeardTopic& topic = stacked.topics[i];
    if (stacked.vertex[i] < 0 || topic.robot == mapping::kLibrary) continue;
    if (topic.robot == self) {
      team.own.emplace(topic.id, clustering.label[i]);
    } else if (!isTooLarge(topic.words)) {
      team.others.push_back({topic.robot, clustering.label[i], topic.words});
    }
  }
  if (team.own.empty()) return {};
  return team;
}

}  // namespace shoal::robot
