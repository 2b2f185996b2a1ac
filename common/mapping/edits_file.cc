// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/edits_file.h"

#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "shoal/mapping/atomic_file.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMaxEdits = 10'000;

Json toJson(const TopicRef& t) {
  return {{"robot", name(t.robot)}, {"topic", number(t.topic)}, {"epoch", t.epoch}};
}

world::RobotId robotFrom(const Json& json) {
  const auto robot = world::parseRobotId(json.get<std::string>());
  if (!robot) throw std::invalid_argument("\"" + json.get<std::string>() + "\" is no robot");
  return *robot;
}

template <typename Integer>
Integer integerFrom(const Json& json) {
  if (!json.is_number_integer()) throw std::invalid_argument(json.dump() + " is no whole number");
  const auto value = json.get<int64_t>();
  if (value < 0 || value > std::numeric_limits<Integer>::max()) {
    throw std::invalid_argument(json.dump() + " is out of range");
  }
  return static_cast<Integer>(value);
}

TopicRef topicFrom(const Json& json) {
  return {robotFrom(json.at("robot")), integerFrom<int32_t>(json.at("epoch")),
          world::TopicId{integerFrom<int32_t>(json.at("topic"))}};
}

EditId idFrom(const Json& json) {
  const auto id = parseEditId(json.get<std::string>());
  if (!id) throw std::invalid_argument("\"" + json.get<std::string>() + "\" is no edit");
  return *id;
}

}  // namespace

Json toJson(const Edit& edit) {
  Json json{{"id", toText(edit.id)}, {"time_us", edit.time.us}, {"edit", std::string(verbOf(edit))}};
  if (const auto* called = std::get_if<NameEdit>(&edit.operation)) {
    json["topics"] = Json::array({toJson(called->topic)});
    json["name"] = called->text;
  } else if (const auto* link = std::get_if<LinkEdit>(&edit.operation)) {
    json["topics"] = Json::array({toJson(link->a), toJson(link->b)});
  } else if (const auto* exclude = std::get_if<ExcludeEdit>(&edit.operation)) {
    json["robot"] = name(exclude->robot);
  } else {
    json["undone"] = toText(std::get<UndoEdit>(edit.operation).edit);
  }
  return json;
}

Edit editFromJson(const Json& json) {
  Edit edit{.id = idFrom(json.at("id")), .time = {integerFrom<int64_t>(json.at("time_us"))}, .operation = {}};
  const std::string verb = json.at("edit");
  if (verb == "name") {
    edit.operation = NameEdit{topicFrom(json.at("topics").at(0)), json.at("name")};
  } else if (verb == "link" || verb == "unlink") {
    const Json& topics = json.at("topics");
    edit.operation = LinkEdit{topicFrom(topics.at(0)), topicFrom(topics.at(1)), verb == "unlink"};
  } else if (verb == "exclude") {
    edit.operation = ExcludeEdit{robotFrom(json.at("robot"))};
  } else if (verb == "undo") {
    edit.operation = UndoEdit{idFrom(json.at("undone"))};
  } else {
    throw std::invalid_argument("\"" + verb + "\" is no edit; name, link, unlink, exclude and undo are");
  }
  if (const std::string why = fault(edit); !why.empty())
    throw std::invalid_argument(toText(edit.id) + ": " + why);
  return edit;
}

std::string editsJson(int64_t mission, std::span<const Edit> edits) {
  Json json{{"mission_id", mission}, {"edits", Json::array()}};
  for (const Edit& edit : edits) json["edits"].push_back(toJson(edit));
  return json.dump(1) + "\n";
}

EditsFile parseEdits(const std::string& text, const std::string& path) {
  try {
    const Json json = Json::parse(text);
    EditsFile file{.mission = integerFrom<int64_t>(json.at("mission_id")), .edits = {}};
    const Json& edits = json.at("edits");
    if (!edits.is_array() || edits.size() > kMaxEdits) {
      throw std::invalid_argument("\"edits\" is a list of at most 10000");
    }
    for (const Json& edit : edits) file.edits.push_back(editFromJson(edit));
    return file;
  } catch (const Json::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

std::vector<Edit> readEdits(const std::string& path, int64_t mission) {
  if (!std::filesystem::exists(path)) return {};
  EditsFile file = parseEdits(readFile(path), path);
  if (file.mission != mission) {
    throw std::runtime_error(path + " is of mission " + std::to_string(file.mission) + ", not of " +
                             std::to_string(mission));
  }
  return std::move(file.edits);
}

}  // namespace shoal::mapping
