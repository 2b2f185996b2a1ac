// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/silence.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>

#include "shoal/rounded.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

// Of a file: who has landed or left may well be silent, and a node ends with the mission.
bool mayBeLost(const Where& where, const Json& node) {
  if (!where.node.empty()) return true;
  return node["phase"] == "flying" || node["phase"] == "listening";
}

bool tellsEvents(const Where& where) {
  return where.run.empty() || std::filesystem::exists(where.run + "/mission.lcmlog");
}

}  // namespace

std::set<std::string> lostNodes(const Json& nodes, const Json& events) {
  struct Lost {
    int times = 0;  // less those that it came back
    double at_s = 0;
  };
  std::map<std::string, Lost> told;
  for (const Json& e : events) {
    Lost& of = told[e["node"].get<std::string>()];
    of.times += e["kind"] == "lost" ? 1 : e["kind"] == "back" ? -1 : 0;
    if (e["kind"] == "lost") of.at_s = std::max(of.at_s, e["at_s"].get<double>());
  }
  std::set<std::string> lost;
  for (const Json& n : nodes) {
    const std::string name = n["name"];
    const auto found = told.find(name);
    if (found == told.end() || found->second.times <= 0) continue;
    // Who told the events may have ended meanwhile, and not have seen it come back.
    if (n["heard_s"].get<double>() <= found->second.at_s) lost.insert(name);
  }
  return lost;
}

double latestHeard(const Json& nodes) {
  double latest_s = 0;
  for (const Json& n : nodes) latest_s = std::max(latest_s, n["heard_s"].get<double>());
  return latest_s;
}

void addSilence(const Asking& asking, Json& nodes, double now_s) {
  const auto may_be_lost = [&asking](const Json& n) { return mayBeLost(asking.where, n); };
  std::set<std::string> lost;
  if (std::ranges::any_of(nodes, may_be_lost) && tellsEvents(asking.where)) {
    const Json answer = ask(whereOf(asking), {{"query", "events"}});
    if (const auto events = answer.find("events"); events != answer.end()) lost = lostNodes(nodes, *events);
  }
  for (Json& n : nodes) {
    n["ago_s"] = rounded(std::max(now_s - n["heard_s"].get<double>(), 0.0), 1e3);
    n["silent"] = may_be_lost(n) && lost.contains(n["name"].get<std::string>());
  }
}

}  // namespace shoal::console
