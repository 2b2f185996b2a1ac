// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/summary.h"

#include <algorithm>
#include <filesystem>
#include <stdexcept>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "operator_console/label_pictures.h"
#include "operator_console/mission_sources.h"
#include "operator_console/render.h"
#include "operator_console/verify.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/queries.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLeastSurprise = 2;
constexpr size_t kSurprisesInText = 3;

std::string labelText(const Json& row) {
  const std::string name = row.at("name");
  return name.empty() ? std::to_string(row.at("label").get<int>()) : name;
}

}  // namespace

MissionSummary readSummaryOf(const std::string& run) {
  MissionSummary mission;
  const mapping::MissionView view = viewOfRun(run);  // says what is wrong with the folder
  mission.facts = Json::parse(mapping::readFile(run + "/summary.json"));
  const auto labels = mapping::labelsAnswer(view).at("labels");
  std::vector<Json> rows(labels.begin(), labels.end());
  std::ranges::stable_sort(rows, std::ranges::greater{},
                           [](const Json& row) { return row.at("area_m2").get<double>(); });
  mission.labels = rows;
  for (const Json& row : mission.labels) mission.area_m2 += row.at("area_m2").get<double>();
  mission.pictures = picturesOfRun(run);
  namespace fs = std::filesystem;
  if (fs::exists(run + "/robots")) {
    const Where where{.node = {}, .run = run, .log = {}, .matcher = matching::usualMatcher()};
    mission.surprises = ask(where, {{"query", "surprises"}, {"least", kLeastSurprise}}).at("places");
  }
  mission.map_png = encodePng(
      render(view.map, world::Grid(view.cell_size_m), "north up", {}, legendPictures(mission.pictures)));
  if (fs::exists(run + "/global_map.png")) mission.truth_png = mapping::readFile(run + "/global_map.png");
  if (fs::exists(run + "/mission.lcmlog")) mission.verified = verify(run + "/mission.lcmlog").json();
  return mission;
}

std::string summaryText(const MissionSummary& mission, size_t max_bytes) {
  if (max_bytes < 80) {
    throw std::invalid_argument("--max-bytes needs 80 at least, got " + std::to_string(max_bytes));
  }
  const Json& f = mission.facts;
  std::vector<std::string> lines;
  lines.push_back(fmt::format("Mission {}: {} robots, {} labels, {:.0f} m2, {}",
                              f.at("mission_id").get<int64_t>(), f.at("robots").size(), mission.labels.size(),
                              mission.area_m2,
                              f.at("converged").get<bool>() ? "all nodes agree" : "nodes DO NOT agree"));
  if (mission.verified) {
    const bool good = mission.verified->at("good");
    lines.push_back(std::string("Recording verified: ") + (good ? "in order" : "NOT in order"));
    for (const Json& line : mission.verified->at("wrong")) lines.push_back("  " + line.get<std::string>());
  }
  for (const Json& row : mission.labels) {
    const int label = row.at("label");
    lines.push_back(fmt::format("{} {:.0f} m2, R{:02} {:.0f} s", labelText(row),
                                row.at("area_m2").get<double>(), label / 10000,
                                row.at("first_seen_s").get<double>()));
  }
  for (size_t i = 0; i < std::min(kSurprisesInText, mission.surprises.size()); ++i) {
    const Json& place = mission.surprises[i];
    lines.push_back(
        fmt::format("strange ({:.1f}, {:.1f}) m, {:.1f}, {} {:.0f} s", place.at("x_m").get<double>(),
                    place.at("y_m").get<double>(), place.at("surprise").get<double>(),
                    place.at("robots").front().get<std::string>(), place.at("first_seen_s").get<double>()));
  }
  std::string text;
  for (const std::string& line : lines) {
    if (text.size() + line.size() + 1 > max_bytes) break;
    text += line + "\n";
  }
  return text;
}

}  // namespace shoal::console
