// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "shoal/mapping/area_answer.h"
#include "shoal/number_check.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct AreaQuestion {
  Asking asking;
  std::string label, since;
  double min_m2 = 0, certainty = 0;
  bool csv = false, geojson = false;
};

void printPatches(const Json& a) {
  const std::string name = a["name"];
  fmt::print("label {}{}: {:.1f} m2 in {} patch{}\n", a["label"].get<int>(),
             name.empty() ? "" : " \"" + name + "\"", a["area_m2"].get<double>(), a["patches"].size(),
             a["patches"].size() == 1 ? "" : "es");
  if (a["patches"].empty()) return;
  fmt::print("{:>5} {:>9} {:>8} {:>8} {:>13} {:>13} {:>5}  {}\n", "patch", "area m2", "x m", "y m", "size m",
             "seen s", "sure", "robots");
  for (size_t i = 0; i < a["patches"].size(); ++i) {
    const Json& p = a["patches"][i];
    const auto box = [&p](size_t corner) { return p["box_m"][corner].get<double>(); };
    const size_t num_robots = p["robots"].size();
    fmt::print(
        "{:>5} {:>9.1f} {:>8.1f} {:>8.1f} {:>13} {:>13} {:>5.2f}  {}\n", i + 1, p["area_m2"].get<double>(),
        p["centroid_m"][0].get<double>(), p["centroid_m"][1].get<double>(),
        fmt::format("{:.1f} x {:.1f}", box(2) - box(0), box(3) - box(1)),
        fmt::format("{:.0f} - {:.0f}", p["first_seen_s"].get<double>(), p["last_seen_s"].get<double>()),
        p["certainty"].get<double>(),
        num_robots > 1 ? fmt::format("{} robots", num_robots) : joined(p["robots"]));
  }
}

int area(const AreaQuestion& q) {
  Json question = {{"query", "area"}, {"label", q.label}, {"min_m2", q.min_m2}, {"certainty", q.certainty}};
  if (!q.since.empty()) question["since_s"] = parseMissionTime(q.since);
  const Json a = answerTo(q.asking, question);
  if (q.asking.json) {
    std::cout << a.dump(2) << '\n';
  } else if (q.csv) {
    std::cout << mapping::areaCsv(a);
  } else if (q.geojson) {
    std::cout << mapping::areasGeoJson(Json::array({a})).dump() << '\n';
  } else {
    printPatches(a);
  }
  return 0;
}

}  // namespace

void addAreaCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("area", "where a label is: its connected patches, largest first");
  const auto q = std::make_shared<AreaQuestion>();
  command->add_option("label", q->label, "number of the label, or its name")->required();
  addWhere(*command, q->asking);
  command->add_option("--min-m2", q->min_m2, "leave out patches below this many square metres")
      ->check(zeroOrMore)
      ->capture_default_str();
  command->add_option("--since", q->since,
                      "only cells seen at or after this mission time: seconds, or 10:20, or 1:10:20");
  command->add_option("--certainty", q->certainty, "only cells at least this certain, in [0, 1]")
      ->check(CLI::Range(0.0, 1.0))
      ->capture_default_str();
  auto* csv = command->add_flag("--csv", q->csv, "answer in CSV, a row a patch");
  auto* geojson =
      command->add_flag("--geojson", q->geojson,
                        "answer in GeoJSON, exact outlines; coordinates in metres of the mission frame");
  csv->excludes(geojson)->excludes(command->get_option("--json"));
  geojson->excludes(command->get_option("--json"));
  command->footer(
      "Cells of the label that touch at an edge or a corner make one patch. Lengths are metres of the\n"
      "mission frame (X east, Y north), times seconds of mission time.\n\n"
      "  operator_console area 10004 --run runs/a --min-m2 3 --certainty 0.8\n"
      "  operator_console area 10004 --node state --since 10:20 --geojson > coral.geojson");
  command->callback([q, &chosen] { chosen = [q] { return area(*q); }; });
}

}  // namespace shoal::console
