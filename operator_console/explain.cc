// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/explain.h"
#include "shoal/rounded.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kRows = 12;

std::string className(const std::vector<world::TruthClass>& classes, int id) {
  if (id < 0) return "no truth";
  for (const world::TruthClass& c : classes) {
    if (c.id == id) return c.name;
  }
  return "class " + std::to_string(id);
}

double percent(int64_t part, int64_t whole) {
  return whole == 0 ? 0.0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
}

}  // namespace

std::string explanationText(const eval::Explanation& e, const std::vector<world::TruthClass>& classes) {
  std::string text = fmt::format(
      "\nEach topic given the class of most of its cells (oracle): AMI {:.3f}; this matcher: {:.3f}\n"
      "Cells whose topic has their class as majority: {:.1f} %; whose label has: {:.1f} %\n\n",
      e.oracle.ami, e.fused.ami, 100 * e.purity, 100 * e.label_purity);
  text += fmt::format("{:<8}{:>8}{:>10}{:>12}{:>12}\n", "robot", "topics", "cells", "pure", "AMI alone");
  for (const eval::Explanation::Robot& r : e.robots) {
    text += fmt::format("{:<8}{:>8}{:>10}{:>10.1f} %{:>12.3f}\n", world::name(r.robot), r.topics, r.cells,
                        100 * r.purity, r.ami);
  }
  text += fmt::format("\n{:<8}{:>10}  {}\n", "label", "cells", "what it holds");
  for (size_t i = 0; i < std::min(kRows, e.labels.size()); ++i) {
    const eval::Explanation::Label& label = e.labels[i];
    std::vector<std::pair<int64_t, int>> parts;
    for (size_t c = 0; c < label.cells_of_class.size(); ++c) {
      if (label.cells_of_class[c] > 0) parts.emplace_back(-label.cells_of_class[c], static_cast<int>(c));
    }
    std::ranges::sort(parts);
    std::string holds;
    for (size_t k = 0; k < std::min<size_t>(3, parts.size()); ++k) {
      holds += fmt::format("{}{:.0f} % {}", k ? ", " : "", percent(-parts[k].first, label.cells),
                           className(classes, parts[k].second));
    }
    text += fmt::format("{:<8}{:>10}  {}\n", number(label.label), label.cells,
                        holds.empty() ? "no truth" : holds);
  }
  if (e.labels.size() > kRows) text += fmt::format("and {} more\n", e.labels.size() - kRows);
  if (!e.confusions.empty()) text += "\nTaken for another class, by the majority of its label:\n";
  for (size_t i = 0; i < std::min(kRows, e.confusions.size()); ++i) {
    const eval::Explanation::Confusion& c = e.confusions[i];
    text += fmt::format("{:>10} cells ({:.1f} %)  {} -> {}\n", c.cells, percent(c.cells, e.fused.scored),
                        className(classes, c.truth), className(classes, c.taken_for));
  }
  return text;
}

Json explanationJson(const eval::Explanation& e, const std::vector<world::TruthClass>& classes) {
  Json robots = Json::array(), labels = Json::array(), confusions = Json::array();
  for (const eval::Explanation::Robot& r : e.robots) {
    robots.push_back({{"robot", world::name(r.robot)},
                      {"topics", r.topics},
                      {"cells", r.cells},
                      {"purity", rounded(r.purity, 1e6)},
                      {"ami", rounded(r.ami, 1e6)}});
  }
  for (const eval::Explanation::Label& label : e.labels) {
    Json holds = Json::object();
    for (size_t c = 0; c < label.cells_of_class.size(); ++c) {
      if (label.cells_of_class[c] > 0)
        holds[className(classes, static_cast<int>(c))] = label.cells_of_class[c];
    }
    labels.push_back({{"label", number(label.label)},
                      {"cells", label.cells},
                      {"majority", className(classes, label.majority)},
                      {"holds", holds}});
  }
  for (const eval::Explanation::Confusion& c : e.confusions) {
    confusions.push_back({{"truth", className(classes, c.truth)},
                          {"taken_for", className(classes, c.taken_for)},
                          {"cells", c.cells}});
  }
  return {{"ami", rounded(e.fused.ami, 1e6)},
          {"oracle_ami", rounded(e.oracle.ami, 1e6)},
          {"topic_purity", rounded(e.purity, 1e6)},
          {"label_purity", rounded(e.label_purity, 1e6)},
          {"robots", robots},
          {"labels", labels},
          {"confusions", confusions}};
}

}  // namespace shoal::console
