// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/picture_files.h"
#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/exports.h"
#include "operator_console/label_pictures.h"
#include "operator_console/render.h"
#include "operator_console/terminal.h"
#include "shoal/mapping/atomic_file.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct Question {
  Asking asking;
  double x = 0, y = 0;
  std::string format, out;
  std::vector<double> origin;  // latitude, longitude
  double heading = 0;
};

void labels(Question& q) {
  Json a = answerTo(q.asking, {{"query", "labels"}});
  for (Json& row : a["labels"]) {
    const Rgb color = colorOf(world::GlobalLabel{row["label"].get<int32_t>()});
    row["color"] = fmt::format("#{:02x}{:02x}{:02x}", color[0], color[1], color[2]);
  }
  if (q.asking.json) {
    addPictures(whereOf(q.asking), a["labels"]);
    std::cout << a.dump(2) << '\n';
    return;
  }
  fmt::print("{:>9}  {:<14} {:>7} {:>10} {:>15} {:>5}  {}\n", "label", "name", "cells", "area m2", "seen s",
             "sure", "robots");
  bool knows = false;
  for (const Json& row : a["labels"]) {
    const int label = row["label"];
    const bool has_library = row.contains("library");
    knows |= has_library;
    fmt::print(
        "{:>9}{} {} {:>7} {:>10.1f} {:>15} {:>5}  {}{}\n", label,
        !has_library             ? ' '
        : row["library"].empty() ? '+'
                                 : '*',
        shortened(row["name"].get<std::string>(), 14), row["cells"].get<int64_t>(),
        row["area_m2"].get<double>(),
        fmt::format("{:.0f} - {:.0f}", row["first_seen_s"].get<double>(), row["last_seen_s"].get<double>()),
        row["certainty"] > 0 ? fmt::format("{:.2f}", row["certainty"].get<double>()) : "-",
        row["robots"].size() > 2 ? fmt::format("{} robots", row["robots"].size()) : joined(row["robots"]),
        isOnTerminal() ? " " + swatch(colorOf(world::GlobalLabel{label})) : "");
  }
  if (knows) fmt::print("* known from the library   + new: nothing in the library is like it\n");
}

void at(Question& q) {
  if (!std::isfinite(q.x) || !std::isfinite(q.y))
    throw std::invalid_argument("X and Y must be metres, finite");
  const Json a = answerTo(q.asking, {{"query", "at"}, {"x", q.x}, {"y", q.y}});
  if (q.asking.json) {
    std::cout << a.dump(2) << '\n';
    return;
  }
  if (a["cells"].empty()) fmt::print("nobody has seen ({} m, {} m)\n", q.x, q.y);
  for (const Json& c : a["cells"]) {
    const std::string name = c["name"];
    fmt::print("({:.3f}, {:.3f}, {:.3f}) m: label {}{}, as {} saw it at {:.3f} s\n", c["x_m"].get<double>(),
               c["y_m"].get<double>(), c["z_m"].get<double>(), c["label"].get<int>(),
               name.empty() ? "" : " \"" + name + "\"", c["robot"].get<std::string>(),
               c["seen_s"].get<double>());
    for (const Json& h : c["history"]) {
      fmt::print("  {:<5} seen {:>10.3f} s  topic {:>4}, label {:>9}  certainty {:.2f}\n",
                 h["robot"].get<std::string>(), h["seen_s"].get<double>(), h["topic"].get<int>(),
                 h["label"].get<int>(), h["certainty"].get<double>());
    }
  }
}

void exportMap(Question& q) {
  if (q.format == "pictures") {
    const auto files = fusion_node::writeLabelPictures(q.out, picturesAt(whereOf(q.asking)));
    if (q.asking.json) {
      std::cout << Json{{"format", q.format}, {"folder", q.out}, {"files", files}}.dump(2) << '\n';
    } else {
      fmt::print("{} files written to {}\n", files.size(), q.out);
    }
    return;
  }
  std::optional<GeoOrigin> origin;
  if (!q.origin.empty()) origin = GeoOrigin{q.origin[0], q.origin[1], q.heading};
  if (q.heading != 0 && !origin)
    throw std::invalid_argument("--heading says how the frame lies at --origin: give both");
  const std::filesystem::path out = q.out;
  Json files = Json::array();
  const Export done = exported(whereOf(q.asking), q.format, out.filename(), origin);
  for (const ExportedFile& file : done.files) {
    files.push_back((out.parent_path() / file.name).string());
    mapping::writeFileAtomically(files.back().get<std::string>(), file.content);
  }
  if (q.asking.json) {
    std::cout << Json{{"format", q.format}, {"file", q.out}, {"files", files}, {"cells", done.cells}}.dump(2)
              << '\n';
  } else {
    const bool is_legend = q.format == "labels";
    fmt::print("{} {} written to {}\n", is_legend ? done.labels : done.cells, is_legend ? "labels" : "cells",
               joined(files, ", "));
  }
}

}  // namespace

void addQuestionCommands(CLI::App& app, Action& chosen) {
  const auto add = [&app, &chosen](const char* name, const char* what, void (*run)(Question&)) {
    CLI::App* command = app.add_subcommand(name, what);
    const auto q = std::make_shared<Question>();
    addWhere(*command, q->asking);
    command->callback([q, run, &chosen] {
      chosen = [q, run] {
        run(*q);
        return 0;
      };
    });
    return std::pair(command, q);
  };
  addStatusCommand(app, chosen);
  CLI::App* labels_command = add("labels", "the legend: every label with its area and robots", labels).first;
  labels_command->footer("  operator_console labels --run runs/a");
  const auto [at_command, at_question] =
      add("at", "what is at X Y, metres of the mission frame: its label and its history", at);
  at_command->footer(
      "Every robot that told of the cell has a line, the one that saw it last first: the map shows that "
      "one.\n\n"
      "  operator_console at 125 -80.5 --node state");
  at_command->add_option("x", at_question->x, "metres")->required();
  at_command->add_option("y", at_question->y, "metres")->required();
  const auto [export_command, export_question] = add("export", "the map as a file", exportMap);
  export_command
      ->add_option("--format", export_question->format,
                   [] {
                     std::string said;
                     for (const ExportFormat& f : exportFormats()) said += f.name + ": " + f.what + "\n";
                     return said + "pictures: a folder with what each label looks like";
                   }())
      ->required()
      ->check(CLI::IsMember([] {
        std::vector<std::string> formats;
        for (const ExportFormat& f : exportFormats()) formats.push_back(f.name);
        formats.push_back("pictures");
        return formats;
      }()));
  export_command
      ->add_option("--out", export_question->out,
                   "file to write; more files of geojson and geotiff are written beside it, called after it")
      ->required();
  export_command
      ->add_option("--origin", export_question->origin,
                   "latitude and longitude of (0, 0), degrees of WGS 84: geojson, geotiff and mcap lie on "
                   "Earth then,\n"
                   "kml has to")
      ->type_name("LAT LON")
      ->expected(2);
  export_command
      ->add_option("--heading", export_question->heading,
                   "with --origin: where +Y points, degrees clockwise from true north")
      ->capture_default_str();
  export_command->footer(
      "Coordinates are metres of the mission frame; with --origin those of a transverse Mercator projection "
      "around "
      "it.\n\n"
      "  operator_console export --format ply --out map.ply --log runs/a/mission.lcmlog\n"
      "  operator_console export --format geotiff --out reef.tif --origin -17.53 177.21 --heading 35 --run "
      "runs/a");
}

}  // namespace shoal::console
