// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/map_changes.h"

#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>
#include <vector>

#include "shoal/mapping/map_files.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;
using Block = std::pair<int32_t, int32_t>;

constexpr int kShift = 6;          // 64 columns
constexpr size_t kRemembered = 4;  // several may ask in turn

Block blockOf(const world::CellIndex& cell) { return {cell.x >> kShift, cell.y >> kShift}; }

std::map<Block, uint64_t> hashesOf(const GlobalMap& map) {
  std::map<Block, uint64_t> hashes;
  Block last{};
  uint64_t* sum = nullptr;
  for (const GlobalCell& c : map.cells) {  // ascending: neighbours are mostly of one block
    if (const Block block = blockOf(c.cell); sum == nullptr || block != last) {
      sum = &hashes[block];
      last = block;
    }
    *sum += cellHash(c.cell, c.robot, c.seen, c.certainty) * labelFactor(c.label);
  }
  return hashes;
}

std::set<Block> differing(const std::map<Block, uint64_t>& before, const std::map<Block, uint64_t>& now) {
  std::set<Block> blocks;
  for (const auto& [block, hash] : now) {
    const auto was = before.find(block);
    if (was == before.end() || was->second != hash) blocks.insert(block);
  }
  for (const auto& [block, hash] : before)
    if (!now.contains(block)) blocks.insert(block);
  return blocks;
}

}  // namespace

Json MapChanges::answer(const MissionView& view, const Json& question) {
  const std::string has = question.at("has"), digest = digestText(view.map_digest);
  const world::Grid grid(view.cell_size_m);
  std::map<Block, uint64_t> now = hashesOf(view.map);
  Json answer{{"cell_size_m", view.cell_size_m}, {"digest", digest}};
  const auto before = std::ranges::find(told_, has, &Told::digest);
  if (before == told_.end()) {
    answer["global_map_csv"] = globalMapCsv(view.map, grid);
  } else {
    const std::set<Block> blocks = differing(before->blocks, now);
    GlobalMap part;
    std::ranges::copy_if(view.map.cells, std::back_inserter(part.cells),
                         [&blocks](const GlobalCell& c) { return blocks.contains(blockOf(c.cell)); });
    answer["since"] = has;
    answer["blocks"] = blocks;
    answer["global_map_csv"] = globalMapCsv(part, grid);
  }
  answer["labels_csv"] = labelsCsv(view.map, grid);
  std::erase_if(told_, [&digest](const Told& told) { return told.digest == digest; });
  told_.push_back({digest, std::move(now)});
  if (told_.size() > kRemembered) told_.pop_front();
  return answer;
}

std::string takeChanges(GlobalMap& map, const Json& answer, const std::string& origin) {
  const world::Grid grid(answer.at("cell_size_m").get<double>());
  GlobalMap part = parseGlobalMap(answer.at("global_map_csv"), answer.at("labels_csv"), grid, origin);
  if (answer.contains("blocks")) {
    const auto blocks = answer.at("blocks").get<std::set<Block>>();
    std::erase_if(map.cells, [&blocks](const GlobalCell& c) { return blocks.contains(blockOf(c.cell)); });
    std::vector<GlobalCell> merged;
    merged.reserve(map.cells.size() + part.cells.size());
    std::ranges::merge(map.cells, part.cells, std::back_inserter(merged), {}, &GlobalCell::cell,
                       &GlobalCell::cell);
    part.cells = std::move(merged);
  }
  map = std::move(part);
  return answer.value("digest", "");
}

}  // namespace shoal::mapping
