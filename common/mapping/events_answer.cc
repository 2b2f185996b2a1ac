// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/events_answer.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "shoal/mapping/edit_question.h"
#include "shoal/mapping/judgement.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

std::vector<MissionEvent> labelsFound(const GlobalMap& map) {
  std::vector<MissionEvent> events;
  for (const LabelSummary& row : map.labels) {
    const world::RobotId finder{number(row.label) / 10000};  // whose topic it is named after
    events.push_back({row.first_seen.seconds(), "label", name(finder),
                      "found label " + std::to_string(number(row.label)) +
                          (row.name.empty() ? "" : ", now called \"" + row.name + "\"")});
  }
  return events;
}

}  // namespace

Json eventsAnswer(const MissionView& view, const BeliefStore& beliefs, std::span<const MissionEvent> seen) {
  std::vector<MissionEvent> events = labelsFound(view.map);
  for (const Edit& edit : editsOf(beliefs)) {
    events.push_back(
        {edit.time.seconds(), "edit", edit.id.author, toText(edit.id) + ": " + sentenceOf(edit)});
  }
  events.insert(events.end(), seen.begin(), seen.end());
  std::ranges::stable_sort(events, {}, &MissionEvent::at_s);
  Json answer{{"events", Json::array()}};
  for (const MissionEvent& e : events) {
    answer["events"].push_back(
        {{"at_s", std::round(e.at_s * 1e3) / 1e3}, {"kind", e.kind}, {"node", e.node}, {"says", e.says}});
  }
  return answer;
}

}  // namespace shoal::mapping
