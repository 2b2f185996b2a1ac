// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/belief_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/csv.h"
#include "shoal/mapping/piece.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> kColumns = {"x_m", "y_m", "z_m", "topic", "seen_s", "certainty"};
const std::vector<std::string> kSurpriseColumns = {"x_m", "y_m", "z_m", "surprise"};

// Four decimals that stand for the same ninth as the exact number: so the files of a run add up to the
// map that was made from what travelled.
std::string certaintyText(float certainty) {
  const int step = certaintySteps(certainty);
  double shown = std::round(static_cast<double>(certainty) * 1e4) / 1e4;
  if (const int read = certaintySteps(static_cast<float>(shown)); read != step)
    shown += read < step ? 1e-4 : -1e-4;
  return fixed(shown, 4);
}

std::string topicsJson(const LocalBelief& belief) {
  Json json;
  if (belief.version.epoch > 0) json["epoch"] = belief.version.epoch;
  if (belief.detail != Detail::kFine) json["detail"] = toText(belief.detail);
  json["vocabulary"] = belief.groups.empty() ? 0 : belief.groups.back().first + belief.groups.back().size;
  json["groups"] = Json::array();
  for (const world::WordGroup& g : belief.groups) {
    json["groups"].push_back({{"name", g.name}, {"first", g.first}, {"size", g.size}});
  }
  json["topics"] = Json::array();
  for (const BelievedTopic& topic : belief.topics) {
    Json words = Json::object();
    for (const auto& [word, count] : topic.words) words[std::to_string(word)] = count;
    json["topics"].push_back({{"id", number(topic.id)},
                              {"weight", topic.weight},
                              {"created_s", topic.created.seconds()},
                              {"words", std::move(words)}});
  }
  return json.dump() + "\n";
}

void parseTopics(const Json& json, LocalBelief& belief) {
  belief.version.epoch = json.value("epoch", 0);
  const std::string detail = json.value("detail", std::string(toText(Detail::kFine)));
  if (!parseDetail(detail)) throw std::invalid_argument("no such detail: " + detail);
  belief.detail = *parseDetail(detail);
  for (const Json& g : json.at("groups")) {
    belief.groups.push_back({g.at("name"), g.at("first"), g.at("size")});
  }
  for (const Json& t : json.at("topics")) {
    BelievedTopic topic{.id = world::TopicId{t.at("id").get<int32_t>()},
                        .created = timeFromSeconds(t.value("created_s", 0.0)),
                        .weight = t.at("weight"),
                        .words = {}};
    for (const auto& [word, count] : t.at("words").items()) {
      topic.words.push_back({static_cast<int32_t>(std::stol(word)), count.get<int32_t>()});
    }
    std::ranges::sort(topic.words);
    belief.topics.push_back(std::move(topic));
  }
  std::ranges::sort(belief.topics, {}, &BelievedTopic::id);
}

}  // namespace

std::string beliefCsv(const LocalBelief& belief, const world::Grid& grid) {
  std::string csv = "x_m,y_m,z_m,topic,seen_s,certainty\n";
  for (const BelievedCell& c : belief.cells) {
    const Eigen::Vector3d p = grid.centerOf(c.cell);
    csv += fixed(p.x(), 3) + ',' + fixed(p.y(), 3) + ',' + fixed(p.z(), 3) + ',' +
           std::to_string(number(c.topic)) + ',' + fixed(c.seen.seconds(), 3) + ',' +
           certaintyText(c.certainty) + '\n';
  }
  return csv;
}

std::string surpriseCsv(const LocalBelief& belief, const world::Grid& grid) {
  std::string csv = "x_m,y_m,z_m,surprise\n";
  for (const BelievedCell& c : belief.cells) {
    const uint8_t steps = surpriseSteps(c.surprise);
    if (steps == 0) continue;
    const Eigen::Vector3d p = grid.centerOf(c.cell);
    csv += fixed(p.x(), 3) + ',' + fixed(p.y(), 3) + ',' + fixed(p.z(), 3) + ',' +
           fixed(static_cast<double>(steps) / kSurpriseStepsPerUnit, 3) + '\n';
  }
  return csv;
}

void writeBelief(const std::string& folder, const LocalBelief& belief, const world::Grid& grid) {
  writeFileAtomically(folder + "/map.csv", beliefCsv(belief, grid));
  writeFileAtomically(folder + "/surprise.csv", surpriseCsv(belief, grid));
  writeFileAtomically(folder + "/topics.json", topicsJson(belief));
}

LocalBelief readTopics(const std::string& path) {
  LocalBelief belief{.robot = {}, .version = {}, .groups = {}, .topics = {}, .cells = {}};
  try {
    parseTopics(Json::parse(readFile(path)), belief);
  } catch (const Json::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  } catch (const std::logic_error&) {
    throw std::runtime_error(path + R"(: the keys of "words" must be word numbers, "detail" fine or coarse)");
  }
  return belief;
}

LocalBelief readBelief(const std::string& folder, world::RobotId robot, const world::Grid& grid) {
  LocalBelief belief = readTopics(folder + "/topics.json");
  belief.robot = robot;
  const std::string map = folder + "/map.csv";
  for (const auto& row : parseCsv(readFile(map), kColumns, map)) {
    belief.cells.push_back({grid.cellOf({toReal(row[0], map), toReal(row[1], map), toReal(row[2], map)}),
                            world::TopicId{static_cast<int32_t>(toInteger(row[3], map))},
                            timeFromSeconds(toReal(row[4], map)), static_cast<float>(toReal(row[5], map))});
  }
  std::ranges::sort(belief.cells, {}, &BelievedCell::cell);
  const std::string surprises = folder + "/surprise.csv";
  if (!std::filesystem::exists(surprises)) return belief;
  for (const auto& row : parseCsv(readFile(surprises), kSurpriseColumns, surprises)) {
    const world::CellIndex index =
        grid.cellOf({toReal(row[0], surprises), toReal(row[1], surprises), toReal(row[2], surprises)});
    const auto cell = std::ranges::lower_bound(belief.cells, index, {}, &BelievedCell::cell);
    if (cell == belief.cells.end() || cell->cell != index)
      throw std::runtime_error(surprises + ": (" + row[0] + ", " + row[1] + ", " + row[2] +
                               ") is no cell of map.csv");
    cell->surprise = static_cast<float>(toReal(row[3], surprises));
  }
  return belief;
}

}  // namespace shoal::mapping
