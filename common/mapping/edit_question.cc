// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/edit_question.h"

#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include "shoal/mapping/area_answer.h"
#include "shoal/mapping/judgement.h"
#include "shoal/mapping/label_name.h"
#include "shoal/world/mission_time.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

std::optional<int32_t> numberIn(const std::string& text) {
  int32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// The topic that a label is named after, or any topic by its own number.
TopicRef topicNamed(const GlobalMap& map, const BeliefStore& beliefs, const Json& label) {
  const std::string text = label.is_number_integer() ? label.dump() : label.get<std::string>();
  const auto known = labelNamed(map, text);
  const std::optional<int32_t> wanted = known ? number(*known) : numberIn(text);
  const bool is_known = known || std::ranges::any_of(map.correspondences, [&](const Correspondence& c) {
                          return wanted && number(world::globalLabel(c.robot, c.topic)) == *wanted;
                        });
  if (!is_known) throw std::invalid_argument(noSuchLabel(map, text));
  const world::RobotId robot{*wanted / 10000};
  return {robot, std::max(0, beliefs.epochOf(robot)), world::TopicId{*wanted % 10000}};
}

world::RobotId robotNamed(const BeliefStore& beliefs, const std::string& text) {
  const auto robot = world::parseRobotId(text);
  if (robot && beliefs.epochOf(*robot) >= 0) return *robot;
  std::string said = "nothing was heard of a robot \"" + text + "\"; heard were";
  for (const world::RobotId heard : beliefs.robots())
    if (heard != kOperators) said += " " + name(heard);
  throw std::invalid_argument(said);
}

EditId toUndo(const std::vector<Edit>& edits, const BeliefStore& beliefs, const Json& question,
              const std::string& author) {
  std::vector<Standing> standings;
  judge(edits, beliefs, &standings);
  if (question.contains("which")) {
    const std::string which = question.at("which");
    const auto id = parseEditId(which);
    const auto edit = std::ranges::find_if(edits, [&](const Edit& e) { return id && e.id == *id; });
    if (edit == edits.end()) throw std::invalid_argument("no edit \"" + which + "\"; edits lists them");
    if (standings[static_cast<size_t>(edit - edits.begin())] == Standing::kUndone) {
      throw std::invalid_argument(which + " is undone already");
    }
    return *id;
  }
  for (size_t i = edits.size(); i-- > 0;) {
    if (edits[i].id.author != author || standings[i] != Standing::kInForce) continue;
    if (!std::holds_alternative<UndoEdit>(edits[i].operation)) return edits[i].id;
  }
  throw std::invalid_argument(author + " has no edit in force; name another's, as in undo " +
                              (edits.empty() ? "OPERATOR/1" : toText(edits.back().id)));
}

std::string text(const TopicRef& t) { return std::to_string(number(world::globalLabel(t.robot, t.topic))); }

}  // namespace

bool isEdit(const Json& question) { return question.contains("edit"); }

Edit makeEdit(const GlobalMap& map, const BeliefStore& beliefs, const Json& question,
              const std::string& author, world::Timestamp now) {
  const std::vector<Edit> edits = editsOf(beliefs);
  Edit edit{.id = {author, 1}, .time = now, .operation = {}};
  for (const Edit& e : edits) {
    edit.time = std::max(edit.time, {std::min(e.time.us + 1, world::kMaxTimeUs)});
    if (e.id.author == author) edit.id.counter = std::max(edit.id.counter, e.id.counter + 1);
  }
  const std::string verb = question.at("edit");
  if (verb == "name") {
    const std::string called = question.at("text");
    if (!isLabelName(called)) {
      throw std::invalid_argument("a name is at most 64 bytes of UTF-8 without control characters");
    }
    if (numberIn(called)) throw std::invalid_argument("\"" + called + "\" is a number; those are labels");
    edit.operation = NameEdit{topicNamed(map, beliefs, question.at("label")), called};
  } else if (verb == "link" || verb == "unlink") {
    TopicRef a = topicNamed(map, beliefs, question.at("a")), b = topicNamed(map, beliefs, question.at("b"));
    if (a == b)
      throw std::invalid_argument(text(a) + " twice; give two, why LABEL lists the topics of a label");
    if (b < a) std::swap(a, b);
    edit.operation = LinkEdit{a, b, verb == "unlink"};
  } else if (verb == "exclude") {
    const world::RobotId robot = robotNamed(beliefs, question.at("robot"));
    if (judge(edits, beliefs).excluded.contains(robot)) {
      throw std::invalid_argument(name(robot) + " is excluded already; undo takes it in again");
    }
    edit.operation = ExcludeEdit{robot};
  } else if (verb == "undo") {
    edit.operation = UndoEdit{toUndo(edits, beliefs, question, author)};
  } else {
    throw std::invalid_argument("\"" + verb + "\" is no edit; name, link, unlink, exclude and undo are");
  }
  if (const std::string why = fault(edit); !why.empty()) throw std::invalid_argument(why);
  return edit;
}

std::string sentenceOf(const Edit& edit) {
  if (const auto* called = std::get_if<NameEdit>(&edit.operation)) {
    return called->text.empty() ? text(called->topic) + " has no name"
                                : text(called->topic) + " is \"" + called->text + "\"";
  }
  if (const auto* link = std::get_if<LinkEdit>(&edit.operation)) {
    return text(link->a) + " and " + text(link->b) + (link->apart ? " are not the same" : " are the same");
  }
  if (const auto* exclude = std::get_if<ExcludeEdit>(&edit.operation))
    return name(exclude->robot) + " does not count";
  return toText(std::get<UndoEdit>(edit.operation).edit) + " is undone";
}

}  // namespace shoal::mapping
