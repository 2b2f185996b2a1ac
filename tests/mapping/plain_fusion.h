// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/judgement.h"
#include "shoal/mapping/label_identity.h"
#include "shoal/mapping/stacked_topics.h"
#include "shoal/mapping/topic_matching.h"

namespace shoal::mapping {

/// Fusion as it is defined, without any store of tiles: every cell in an ordered map, every time anew. What
/// fuse() and FusedMap must equal.
inline GlobalMap fusePlainly(const BeliefStore& beliefs, const matching::MatcherOptions& options) {
  const Judgement judgement = judge(beliefs);
  const StackedTopics stacked = stack(beliefs, judgement.excluded);
  const std::vector<world::GlobalLabel> labels =
      stableLabels(stacked, matchTopics(stacked, options, judgement));
  GlobalMap map;
  map.state_digest = beliefs.digest();
  std::map<Topic, world::GlobalLabel> label;
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    label[{stacked.topics[i].robot, stacked.topics[i].id}] = labels[i];
    map.correspondences.push_back({stacked.topics[i].robot, stacked.topics[i].id, labels[i]});
  }
  std::map<world::CellIndex, GlobalCell> cells;
  const auto each = [&](auto&& visit) {
    beliefs.visit([&](const Piece& piece) {
      if (!judgement.excluded.contains(piece.key.robot)) visit(piece);
    });
  };
  each([&](const Piece& piece) {
    const auto* brick = std::get_if<BrickPart>(&piece.content);
    if (brick == nullptr) return;
    for (const BrickCell& c : brick->cells) {
      const world::RobotId robot = piece.key.robot;
      const auto known = label.find({robot, c.topic});
      const world::GlobalLabel shown =
          known == label.end() ? world::globalLabel(robot, c.topic) : known->second;
      const auto held = cells.find(c.cell);
      if (held == cells.end() ||
          std::pair(held->second.seen, held->second.robot) < std::pair(c.seen, robot)) {
        cells[c.cell] = {c.cell, shown, robot, c.seen, 0};
      }
    }
  });
  each([&](const Piece& piece) {
    const auto* part = std::get_if<CertaintyPart>(&piece.content);
    if (part == nullptr) return;
    for (const CertaintyCell& c : part->cells) {
      const auto held = cells.find(c.cell);
      if (held != cells.end() && held->second.robot == piece.key.robot)
        held->second.certainty = static_cast<float>(c.steps) / kCertaintySteps;
    }
  });
  std::map<world::GlobalLabel, LabelSummary> rows;
  std::map<world::GlobalLabel, std::set<world::RobotId>> robots;
  for (const auto& [index, c] : cells) {
    map.cells.push_back(c);
    const auto [row, is_new] = rows.emplace(c.label, LabelSummary{c.label, "", 0, {}, c.seen});
    ++row->second.cells;
    row->second.first_seen = std::min(row->second.first_seen, c.seen);
    robots[c.label].insert(c.robot);
  }
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    const auto row = rows.find(labels[i]);
    if (row == rows.end()) continue;
    row->second.first_seen = std::min(row->second.first_seen, stacked.topics[i].created);
    robots[labels[i]].insert(stacked.topics[i].robot);
  }
  for (auto& [number, row] : rows) {
    row.robots.assign(robots[number].begin(), robots[number].end());
    std::vector<Topic> topics{
        {world::RobotId{world::number(number) / 10000}, world::TopicId{world::number(number) % 10000}}};
    for (const Correspondence& c : map.correspondences)
      if (c.label == number) topics.push_back({c.robot, c.topic});
    row.name = judgement.nameOf(topics);
    map.labels.push_back(row);
  }
  return map;
}

}  // namespace shoal::mapping
