// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/fusion.h"

#include <algorithm>
#include <map>
#include <tuple>
#include <unordered_map>

#include "shoal/mapping/judgement.h"
#include "shoal/mapping/label_identity.h"
#include "shoal/mapping/stacked_topics.h"
#include "shoal/mapping/topic_matching.h"

namespace shoal::mapping {
namespace {

using Translation = std::map<std::pair<world::RobotId, world::TopicId>, world::GlobalLabel>;

world::GlobalLabel translate(const Translation& translation, world::RobotId robot, world::TopicId topic) {
  const auto known = translation.find({robot, topic});
  return known == translation.end() ? world::globalLabel(robot, topic) : known->second;
}

// Newest observer wins, the higher robot number among equals: Jamieson et al. §III, n*_b.
std::vector<GlobalCell> newestCells(const BeliefStore& beliefs, const Translation& translation,
                                    const std::set<world::RobotId>& excluded) {
  std::vector<GlobalCell> cells;
  std::unordered_map<world::CellIndex, size_t, world::CellHash> place;  // looked up only, never iterated
  beliefs.visit([&](const Piece& piece) {
    const auto* brick = std::get_if<BrickPart>(&piece.content);
    if (brick == nullptr || excluded.contains(piece.key.robot)) return;
    for (const BrickCell& c : brick->cells) {
      const GlobalCell mine{c.cell, translate(translation, piece.key.robot, c.topic), piece.key.robot, c.seen,
                            0};
      const auto [held, inserted] = place.emplace(c.cell, cells.size());
      if (inserted) {
        cells.push_back(mine);
      } else if (GlobalCell& other = cells[held->second];
                 std::tie(other.seen, other.robot) < std::tie(mine.seen, mine.robot)) {
        other = mine;
      }
    }
  });
  beliefs.visit([&](const Piece& piece) {
    const auto* part = std::get_if<CertaintyPart>(&piece.content);
    if (part == nullptr) return;
    for (const CertaintyCell& c : part->cells) {
      const auto held = place.find(c.cell);
      if (held == place.end() || cells[held->second].robot != piece.key.robot) continue;
      cells[held->second].certainty = static_cast<float>(c.steps) / kCertaintySteps;
    }
  });
  std::ranges::sort(cells, {}, &GlobalCell::cell);
  return cells;
}

bool containsRobot(const std::vector<world::RobotId>& robots, world::RobotId robot) {
  return std::ranges::find(robots, robot) != robots.end();
}

// Names stick to topics: a label has the newest name of its topics.
void giveNames(std::vector<LabelSummary>& rows, const Judgement& judgement,
               const std::vector<Correspondence>& correspondences) {
  if (judgement.names.empty()) return;
  std::map<world::GlobalLabel, std::vector<Topic>> topics;
  for (const Correspondence& c : correspondences) topics[c.label].push_back({c.robot, c.topic});
  for (LabelSummary& row : rows) {
    topics[row.label].push_back(
        {world::RobotId{number(row.label) / 10000}, world::TopicId{number(row.label) % 10000}});
    row.name = judgement.nameOf(topics[row.label]);
  }
}

std::vector<LabelSummary> summarize(const std::vector<GlobalCell>& cells, const StackedTopics& stacked,
                                    const std::vector<world::GlobalLabel>& labels) {
  std::map<world::GlobalLabel, LabelSummary> rows;
  for (const GlobalCell& c : cells) {
    LabelSummary& row = rows[c.label];
    if (row.cells++ == 0)
      row = {.label = c.label, .name = "", .cells = 1, .robots = {}, .first_seen = c.seen};
    if (!containsRobot(row.robots, c.robot)) row.robots.push_back(c.robot);
    row.first_seen = std::min(row.first_seen, c.seen);
  }
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    const auto row = rows.find(labels[i]);
    if (row == rows.end()) continue;
    if (!containsRobot(row->second.robots, stacked.topics[i].robot)) {
      row->second.robots.push_back(stacked.topics[i].robot);
    }
    row->second.first_seen = std::min(row->second.first_seen, stacked.topics[i].created);
  }
  std::vector<LabelSummary> summaries;
  for (auto& [label, row] : rows) {
    std::ranges::sort(row.robots);
    summaries.push_back(std::move(row));
  }
  return summaries;
}

}  // namespace

GlobalMap fuse(const BeliefStore& beliefs, const matching::MatcherOptions& options) {
  const Judgement judgement = judge(beliefs);
  const StackedTopics stacked =
      stack(beliefs, judgement.excluded);  // canonical order, whatever arrived first
  const matching::Clustering clustering = matchTopics(stacked, options, judgement);
  const std::vector<world::GlobalLabel> labels = stableLabels(stacked, clustering);

  GlobalMap map;
  Translation translation;
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    const HeardTopic& topic = stacked.topics[i];
    translation.emplace(std::pair(topic.robot, topic.id), labels[i]);
    map.correspondences.push_back({topic.robot, topic.id, labels[i]});
  }
  map.cells = newestCells(beliefs, translation, judgement.excluded);
  map.labels = summarize(map.cells, stacked, labels);
  giveNames(map.labels, judgement, map.correspondences);
  map.state_digest = beliefs.digest();
  return map;
}

}  // namespace shoal::mapping
