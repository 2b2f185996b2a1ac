// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/edits_answer.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include "shoal/mapping/edit_question.h"
#include "shoal/mapping/edits_file.h"
#include "shoal/mapping/judgement.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

Json told(const Edit& edit, Standing standing) {
  Json json = toJson(edit);
  json["author"] = edit.id.author;
  json["time_s"] = std::round(edit.time.seconds() * 1e3) / 1e3;
  json["says"] = sentenceOf(edit);
  json["standing"] = std::string(toText(standing));
  return json;
}

}  // namespace

Json editsAnswer(const BeliefStore& beliefs) {
  const std::vector<Edit> edits = editsOf(beliefs);
  std::vector<Standing> standings;
  const Judgement judgement = judge(edits, beliefs, &standings);
  Json answer{{"edits", Json::array()}, {"excluded", Json::array()}};
  for (size_t i = 0; i < edits.size(); ++i) answer["edits"].push_back(told(edits[i], standings[i]));
  for (const world::RobotId robot : judgement.excluded) answer["excluded"].push_back(name(robot));
  return answer;
}

Json editAnswer(const Edit& edit, const BeliefStore& beliefs) {
  const std::vector<Edit> edits = editsOf(beliefs);
  std::vector<Standing> standings;
  judge(edits, beliefs, &standings);
  for (size_t i = 0; i < edits.size(); ++i)
    if (edits[i] == edit) return told(edit, standings[i]);
  return told(edit, Standing::kVoid);
}

}  // namespace shoal::mapping
