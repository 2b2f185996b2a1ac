// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/silence.h"
#include "operator_console/terminal.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct NodeQuestion {
  Asking asking;
  std::string name;
};

std::string agreementText(const std::string& agreement) {
  if (agreement == "same") return "its map is the same as this one";
  if (agreement == "behind") return "its map was made from another state";
  if (agreement == "other") return "ITS MAP DIFFERS from this one, though made from the same state";
  return "it makes no map";
}

void printNode(const Json& a) {
  const Json& n = a["node"];
  const bool is_robot = n["phase"] != "node";
  const std::string phase = n["phase"];
  fmt::print("{}: {}, heard at {:.1f} s, {:.1f} s ago\n", n["name"].get<std::string>(),
             n["silent"].get<bool>() ? alarming("silent") + ", last " + phase : phase,
             n["heard_s"].get<double>(), a["silent_s"].get<double>());
  if (is_robot) {
    fmt::print("image {} of {}, at ({:.1f}, {:.1f}, {:.1f}) m\n", n["observation"].get<int>() + 1,
               n["num_observations"].get<int>(), n["position_m"][0].get<double>(),
               n["position_m"][1].get<double>(), n["position_m"][2].get<double>());
    fmt::print("it has {} cells; {} were told, the map shows {} of them\n", n["cells"].get<int64_t>(),
               a["cells_told"].get<int64_t>(), a["cells_shown"].get<int64_t>());
    if (!a["told_until_s"].is_null()) {
      fmt::print("what it told was seen until {:.1f} s\n", a["told_until_s"].get<double>());
    }
    fmt::print("{}\n", n["heard_whole"].get<bool>() ? "digests agree: all it has to say was heard"
                                                    : "digests differ: something was not heard yet");
  }
  fmt::print("{}\n", agreementText(n["agreement"].get<std::string>()));
  if (a["topics"].empty()) return;
  fmt::print("{:>6} {:>9}  {:<16} {:>7} {:>9} {:>9}\n", "topic", "label", "name", "cells", "words",
             "since s");
  for (const Json& t : a["topics"]) {
    fmt::print("{:>6} {:>9}  {} {:>7} {:>9} {:>9.1f}\n", t["topic"].get<int>(), t["label"].get<int>(),
               shortened(t["name"].get<std::string>(), 16), t["cells"].get<int64_t>(),
               t["weight"].get<int64_t>(), t["created_s"].get<double>());
  }
}

int node(const NodeQuestion& q) {
  Json a = answerTo(q.asking, {{"query", "node"}, {"node", q.name}});
  Json nodes = Json::array({a["node"]});
  addSilence(q.asking, nodes, a["now_s"]);
  a["node"] = nodes[0];
  if (q.asking.json) {
    std::cout << a.dump(2) << '\n';
  } else {
    printNode(a);
  }
  return 0;
}

}  // namespace

void addNodeCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("node", "what a robot or node has told, and how old that is");
  const auto q = std::make_shared<NodeQuestion>();
  command->add_option("name", q->name, "R03, OPERATOR, ...")->required();
  addWhere(*command, q->asking);
  command->footer(
      "  operator_console node R03 --node state\n"
      "  operator_console node R03 --run runs/a --json");
  command->callback([q, &chosen] { chosen = [q] { return node(*q); }; });
}

}  // namespace shoal::console
