// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/process.h"
#include "operator_console/command.h"
#include "operator_console/mission_sources.h"
#include "operator_console/render.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/map_files.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct Question {
  Where where;
  std::string sigma = "auto", similarity;
  bool json = false;
  double x = 0, y = 0;
  std::string format, out;
};

void addWhere(CLI::App& command, Question& q) {
  auto* where = command.add_option_group("where", "whom to ask: exactly one");
  where->add_option("--node", q.where.node, "state folder of a running fusion_node");
  where->add_option("--run", q.where.run, "folder of a finished mission");
  where->add_option("--log", q.where.log, "a recording made by lcm-logger");
  where->require_option(1);
  command.add_option("--matcher", q.where.matcher.matcher, "for --log: id, hungarian, clear or shoal")
      ->capture_default_str();
  command.add_option("--similarity", q.similarity, "for --log: cosine, overlap, l1, l2 or discounted");
  command
      .add_option("--sigma", q.sigma, "for --log: least similarity of a match: auto or a number in (0, 1]")
      ->capture_default_str();
  command.add_flag("--json", q.json, "answer in JSON");
}

void complete(Question& q) {
  q.where.matcher.sigma = matching::parseSigma(q.sigma);
  q.where.matcher.similarity =
      q.similarity.empty() ? matching::usualSimilarity(q.where.matcher.matcher) : q.similarity;
}

Json answerTo(Question& q, const Json& question) {
  complete(q);
  Json answer = ask(q.where, question);
  if (answer.contains("error")) throw std::runtime_error(answer.at("error").get<std::string>());
  return answer;
}

std::string joined(const Json& list) {
  std::string text;
  for (const Json& item : list) text += (text.empty() ? "" : " ") + item.get<std::string>();
  return text;
}

void status(Question& q) {
  const Json a = answerTo(q, {{"query", "status"}});
  if (q.json) {
    std::cout << a.dump(2) << '\n';
    return;
  }
  fmt::print("mission {}: {} cells, {} labels, cells of {} m, state {}, map {}\n",
             a["mission_id"].get<int64_t>(), a["cells"].get<int64_t>(), a["labels"].get<int64_t>(),
             a["cell_size_m"].get<double>(), a["digest"]["state"].get<std::string>(),
             a["digest"]["map"].get<std::string>());
  fmt::print("{:<10} {:<8} {:>9} {:>11} {:>7} {:>7} {:>9} {:>8} {:>7} {:>9} {}\n", "node", "phase", "heard s",
             "images", "topics", "cells", "ms/image", "sent B", "queue B", "refused", "heard whole");
  for (const Json& n : a["nodes"]) {
    const bool flies = n["phase"] != "node";
    fmt::print(
        "{:<10} {:<8} {:>9.1f} {:>11} {:>7} {:>7} {:>9.1f} {:>8} {:>7} {:>9} {}\n",
        n["name"].get<std::string>(), n["phase"].get<std::string>(), n["heard_s"].get<double>(),
        flies ? fmt::format("{}/{}", n["observation"].get<int>() + 1, n["num_observations"].get<int>()) : "-",
        n["topics"].get<int>(), n["cells"].get<int>(), n["ms_per_frame"].get<double>(),
        n["bytes_sent"].get<int64_t>(), n["queue_bytes"].get<int>(), n["rejected"].get<int>(),
        flies ? (n["heard_whole"].get<bool>() ? "yes" : "no") : "-");
  }
}

void labels(Question& q) {
  const Json a = answerTo(q, {{"query", "labels"}});
  if (q.json) {
    std::cout << a.dump(2) << '\n';
    return;
  }
  fmt::print("{:>9}  {:<16} {:>7} {:>12} {:>12}  {}\n", "label", "name", "cells", "area m2", "first seen s",
             "robots");
  for (const Json& row : a["labels"]) {
    fmt::print("{:>9}  {:<16} {:>7} {:>12.1f} {:>12.1f}  {}\n", row["label"].get<int>(),
               row["name"].get<std::string>(), row["cells"].get<int64_t>(), row["area_m2"].get<double>(),
               row["first_seen_s"].get<double>(), joined(row["robots"]));
  }
}

void at(Question& q) {
  const Json a = answerTo(q, {{"query", "at"}, {"x", q.x}, {"y", q.y}});
  if (q.json) {
    std::cout << a.dump(2) << '\n';
    return;
  }
  if (a["cells"].empty()) fmt::print("nobody has seen ({} m, {} m)\n", q.x, q.y);
  for (const Json& c : a["cells"]) {
    fmt::print("({:.3f}, {:.3f}, {:.3f}) m  label {} {} seen by {} at {:.3f} s, certainty {:.2f}\n",
               c["x_m"].get<double>(), c["y_m"].get<double>(), c["z_m"].get<double>(), c["label"].get<int>(),
               c["name"].get<std::string>(), c["robot"].get<std::string>(), c["seen_s"].get<double>(),
               c["certainty"].get<double>());
  }
}

void exportMap(Question& q) {
  complete(q);
  const mapping::MissionView view = viewOf(q.where);
  const world::Grid grid(view.cell_size_m);
  std::string content;
  if (q.format == "csv") {
    content = mapping::globalMapCsv(view.map, grid);
  } else if (q.format == "labels") {
    content = mapping::labelsCsv(view.map, grid);
  } else {
    content = encodePng(render(view.map, grid, fmt::format("mission {}", view.mission)));
  }
  mapping::writeFileAtomically(q.out, content);
  if (q.json) {
    std::cout << Json{{"format", q.format}, {"file", q.out}, {"cells", view.map.cells.size()}}.dump(2)
              << '\n';
  } else {
    fmt::print("{} cells written to {}\n", view.map.cells.size(), q.out);
  }
}

}  // namespace

void addQuestionCommands(CLI::App& app, Action& chosen) {
  const auto add = [&app, &chosen](const char* name, const char* what, void (*run)(Question&)) {
    CLI::App* command = app.add_subcommand(name, what);
    const auto q = std::make_shared<Question>();
    addWhere(*command, *q);
    command->callback([q, run, &chosen] {
      chosen = [q, run] {
        run(*q);
        return 0;
      };
    });
    return std::pair(command, q);
  };
  add("status", "how every node of a mission is doing", status);
  add("labels", "the legend: every label with its area and robots", labels);
  const auto [at_command, at_question] = add("at", "what is at X Y (metres, world)", at);
  at_command->add_option("x", at_question->x, "metres")->required();
  at_command->add_option("y", at_question->y, "metres")->required();
  const auto [export_command, export_question] = add("export", "the map as a file", exportMap);
  export_command
      ->add_option("--format", export_question->format, "csv (cells), labels (CSV of the legend) or png")
      ->required()
      ->check(CLI::IsMember({"csv", "labels", "png"}));
  export_command->add_option("--out", export_question->out, "file to write")->required();
}

}  // namespace shoal::console
