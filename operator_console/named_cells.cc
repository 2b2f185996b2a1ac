// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/named_cells.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>

#include "shoal/eval/ami_estimate.h"
#include "shoal/mapping/csv.h"
#include "shoal/random.h"
#include "shoal/rounded.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> kNamedColumns{"x_m", "y_m", "z_m", "robot", "seen_s", "name"};

std::string trimmed(const std::string& text) {
  const auto first = text.find_first_not_of(" \t");
  return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

double coordinate(const std::string& field, double cell_size_m, const std::string& line) {
  const double value = mapping::toReal(trimmed(field), line);
  if (!(std::abs(value) / cell_size_m < 1e9)) {
    throw std::runtime_error(line + ": " + field + " m is out of reach");
  }
  return value;
}

}  // namespace

std::string cellsToName(const mapping::MissionView& view, int64_t count, uint64_t seed) {
  std::vector<size_t> order(view.map.cells.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  Random random(seed, static_cast<uint64_t>(view.mission), order.size());
  const size_t drawn = std::min(order.size(), static_cast<size_t>(std::max<int64_t>(count, 0)));
  for (size_t i = 0; i < drawn; ++i) std::swap(order[i], order[i + random.below(order.size() - i)]);
  order.resize(drawn);
  std::ranges::sort(order);
  const world::Grid grid(view.cell_size_m);
  std::string csv = "x_m,y_m,z_m,robot,seen_s,name\n";
  for (const size_t i : order) {
    const mapping::GlobalCell& c = view.map.cells[i];
    const Eigen::Vector3d p = grid.centerOf(c.cell);
    csv += mapping::fixed(p.x(), 3) + ',' + mapping::fixed(p.y(), 3) + ',' + mapping::fixed(p.z(), 3) + ',' +
           world::name(c.robot) + ',' + mapping::fixed(c.seen.seconds(), 3) + ",\n";
  }
  return csv;
}

NamedCells parseNamedCells(const std::string& csv, const world::Grid& grid, const std::string& path) {
  NamedCells named;
  std::set<world::CellIndex> met;
  int64_t line_number = 1;
  for (const auto& row : mapping::parseCsv(csv, kNamedColumns, path)) {
    const std::string line = path + " line " + std::to_string(++line_number);
    const std::string name = trimmed(row[5]);
    const world::CellIndex cell =
        grid.cellOf({coordinate(row[0], grid.cellSize(), line), coordinate(row[1], grid.cellSize(), line),
                     coordinate(row[2], grid.cellSize(), line)});
    if (!met.insert(cell).second) throw std::runtime_error(line + ": this cell stands above already");
    if (name.empty()) {
      ++named.unnamed;
    } else {
      named.cells.push_back({cell, name});
    }
  }
  return named;
}

Json namedScore(const mapping::MissionView& view, const NamedCells& named) {
  std::map<std::string, int> number_of_name;
  std::map<world::GlobalLabel, std::map<std::string, int64_t>> met;  // label, name, cells
  std::vector<int> labels, names;
  for (const NamedCell& n : named.cells) {
    const auto found = std::ranges::lower_bound(view.map.cells, n.cell, {}, &mapping::GlobalCell::cell);
    if (found == view.map.cells.end() || found->cell != n.cell) continue;
    labels.push_back(number(found->label));
    names.push_back(number_of_name.emplace(n.name, static_cast<int>(number_of_name.size())).first->second);
    ++met[found->label][n.name];
  }
  const eval::AmiEstimate e = eval::estimateAmi(labels, names, std::ssize(view.map.cells));
  Json by_label = Json::array();
  for (const auto& [label, counts] : met) {
    int64_t cells = 0;
    const auto* most = &*counts.begin();
    for (const auto& count : counts) {
      cells += count.second;
      if (count.second > most->second) most = &count;
    }
    const auto row = std::ranges::find(view.map.labels, label, &mapping::LabelSummary::label);
    by_label.push_back(
        {{"label", number(label)},
         {"name", row == view.map.labels.end() ? "" : row->name},
         {"named", cells},
         {"most_often", most->first},
         {"share", rounded(static_cast<double>(most->second) / static_cast<double>(cells), 1e4)}});
  }
  std::stable_sort(by_label.begin(), by_label.end(), [](const Json& a, const Json& b) {
    return a["named"].get<int64_t>() > b["named"].get<int64_t>();
  });
  return {{"cells", view.map.cells.size()}, {"named", labels.size()},
          {"unnamed", named.unnamed},       {"off_map", std::ssize(named.cells) - std::ssize(labels)},
          {"labels", met.size()},           {"names", number_of_name.size()},
          {"ami", rounded(e.ami, 1e6)},     {"low", rounded(e.low, 1e6)},
          {"high", rounded(e.high, 1e6)},   {"by_label", by_label}};
}

}  // namespace shoal::console
