// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/map_changes.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <utility>

#include "shoal/mapping/map_files.h"
#include "shoal/mapping/queries.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kRemembered = 4;  // several may ask in turn

std::set<BrickColumn> differing(const std::map<BrickColumn, uint64_t>& before,
                                const std::map<BrickColumn, uint64_t>& now) {
  std::set<BrickColumn> columns;
  for (const auto& [column, hash] : now) {
    const auto was = before.find(column);
    if (was == before.end() || was->second != hash) columns.insert(column);
  }
  for (const auto& [column, hash] : before)
    if (!now.contains(column)) columns.insert(column);
  return columns;
}

}  // namespace

// Brings the census of every column up to date.
void MapChanges::count(const MapInColumns& map) {
  std::erase_if(counted_, [&map](const auto& entry) { return !map.hashes.contains(entry.first); });
  std::set<BrickColumn> stale;
  for (const auto& [column, hash] : map.hashes) {
    const auto known = counted_.find(column);
    if (known == counted_.end() || known->second.hash != hash) stale.insert(column);
  }
  std::map<BrickColumn, std::vector<GlobalCell>> cells;
  for (const GlobalCell& c : map.cells_in(stale)) cells[brickColumnOf(c.cell)].push_back(c);
  for (const auto& [column, list] : cells) counted_[column] = {map.hashes.at(column), censusOf(list)};
}

Json MapChanges::answer(const MapInColumns& map, const Json& question) {
  const std::string has = question.at("has"), digest = digestText(map.digest);
  const world::Grid grid(map.cell_size_m);
  count(map);
  LabelCensus census;
  for (const auto& [column, counted] : counted_) add(census, counted.census);
  Json answer{{"cell_size_m", map.cell_size_m}, {"digest", digest}};
  GlobalMap part;
  const auto before = std::ranges::find(told_, has, &Told::digest);
  if (before == told_.end()) {
    std::set<BrickColumn> all;
    for (const auto& [column, hash] : map.hashes) all.insert(all.end(), column);
    part.cells = map.cells_in(all);
  } else {
    const std::set<BrickColumn> columns = differing(before->hashes, map.hashes);
    part.cells = map.cells_in(columns);
    answer["since"] = has;
    answer["columns"] = columns;
  }
  answer["global_map_csv"] = globalMapCsv(part, grid);
  answer["surprises"] = Json::array();
  const std::vector<uint8_t> surprises = map.surprises_of(part.cells);
  for (size_t i = 0; i < surprises.size(); ++i)
    if (surprises[i] > 0) answer["surprises"].push_back({i, surprises[i]});
  answer["labels_csv"] = labelsCsv(map.labels, areasOf(census, grid));
  answer["labels"] = labelRows(map.labels, census, grid);
  std::erase_if(told_, [&digest](const Told& told) { return told.digest == digest; });
  told_.push_back({digest, map.hashes});
  if (told_.size() > kRemembered) told_.pop_front();
  return answer;
}

MapChange readChange(const Json& answer, const std::string& origin) {
  const world::Grid grid(answer.at("cell_size_m").get<double>());
  MapChange change;
  change.part = parseGlobalMap(answer.at("global_map_csv"), answer.at("labels_csv"), grid, origin);
  change.is_whole = !answer.contains("columns");
  if (!change.is_whole) change.columns = answer.at("columns").get<std::set<BrickColumn>>();
  change.digest = answer.value("digest", "");
  if (answer.contains("surprises")) {
    change.surprises.resize(change.part.cells.size());
    for (const auto& [row, steps] : answer.at("surprises").get<std::vector<std::pair<size_t, uint8_t>>>()) {
      if (row >= change.surprises.size()) throw std::runtime_error(origin + " told of a surprise nowhere");
      change.surprises[row] = steps;
    }
  }
  const auto is_told = [&change](const GlobalCell& c) {
    return change.columns.contains(brickColumnOf(c.cell));
  };
  if (!change.is_whole && !std::ranges::all_of(change.part.cells, is_told)) {
    throw std::runtime_error(origin + " told of cells outside the columns that it named");
  }
  return change;
}

}  // namespace shoal::mapping
