// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/node_answer.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "shoal/mapping/stacked_topics.h"
#include "shoal/rounded.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

// To milliseconds. A heartbeat's time is rounded before anything is counted from it, as every answer and file
// tells it: a run's files and its recording give one answer.
double milliseconds(double seconds) { return rounded(seconds, 1e3); }

std::string unknownNode(const MissionView& view, const std::string& node) {
  std::string said = "nothing was heard of \"" + node + "\"; heard were";
  for (const NodeStatus& n : view.nodes) said += " " + n.name;
  return said + (view.nodes.empty() ? " none" : "");
}

Json topicsTold(const MissionView& view, const BeliefStore& beliefs, world::RobotId robot) {
  std::map<world::TopicId, world::GlobalLabel> label_of;
  for (const Correspondence& c : view.map.correspondences)
    if (c.robot == robot) label_of[c.topic] = c.label;
  Json told = Json::array();
  for (const HeardTopic& topic : stack(beliefs).topics) {
    if (topic.robot != robot) continue;
    const auto known = label_of.find(topic.id);
    const auto label = known == label_of.end() ? world::globalLabel(robot, topic.id) : known->second;
    const auto row = std::ranges::find(view.map.labels, label, &LabelSummary::label);
    told.push_back({{"topic", number(topic.id)},
                    {"label", number(label)},
                    {"name", row == view.map.labels.end() ? "" : row->name},
                    {"cells", topic.cells},
                    {"weight", topic.weight},
                    {"created_s", milliseconds(topic.created.seconds())}});
  }
  return told;
}

}  // namespace

Json nodeAnswer(const MissionView& view, const BeliefStore& beliefs, const std::string& node) {
  const auto status = std::ranges::find(view.nodes, node, &NodeStatus::name);
  if (status == view.nodes.end()) return {{"error", unknownNode(view, node)}};
  const double heard_s = milliseconds(status->heard_s);
  double now_s = heard_s;
  for (const NodeStatus& n : view.nodes) now_s = std::max(now_s, milliseconds(n.heard_s));
  const auto robot = world::parseRobotId(node);
  int64_t cells = 0, shown = 0;
  std::optional<world::Timestamp> told_until;
  beliefs.visit([&](const Piece& piece) {
    const auto* brick = std::get_if<BrickPart>(&piece.content);
    if (brick == nullptr || !robot || piece.key.robot != *robot) return;
    cells += std::ssize(brick->cells);
    for (const BrickCell& c : brick->cells) told_until = told_until ? std::max(*told_until, c.seen) : c.seen;
  });
  for (const GlobalCell& c : view.map.cells) shown += robot && c.robot == *robot ? 1 : 0;
  return {{"node", toJson(*status)},
          {"now_s", now_s},
          {"silent_s", milliseconds(now_s - heard_s)},
          {"cells_told", cells},
          {"cells_shown", shown},
          {"told_until_s", told_until ? Json(milliseconds(told_until->seconds())) : Json()},
          {"behind_s", told_until ? Json(milliseconds(heard_s - told_until->seconds())) : Json()},
          {"topics", robot ? topicsTold(view, beliefs, *robot) : Json::array()}};
}

}  // namespace shoal::mapping
