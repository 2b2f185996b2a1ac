// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/told_surprises.h"

#include <algorithm>
#include <set>
#include <variant>

#include "shoal/random.h"

namespace shoal::mapping {
void ToldSurprises::update(const BeliefStore& beliefs) {
  for (const world::RobotId robot : beliefs.robots()) {
    const int32_t epoch = beliefs.epochOf(robot);
    const auto [known, is_new] = epochs_.emplace(robot, epoch);
    if (is_new || known->second == epoch) continue;
    known->second = epoch;
    forget(robot);
  }
  beliefs.visitChanges(revision_, [&](const PieceKey& key) {
    if (key.kind != PieceKind::kCertainty) return;
    Told told;  // parts in order: the last one's word counts
    beliefs.visitOf(key, [&](const Piece& piece) {
      for (const CertaintyCell& c : std::get<CertaintyPart>(piece.content).cells)
        if (c.surprise > 0) told[c.cell] = c.surprise;
    });
    const BrickColumn column{key.index[0], key.index[1]};
    const Brick brick{key.robot, key.index[2]};
    if (!told.empty()) {
      told_[column][brick] = std::move(told);
    } else if (const auto at = told_.find(column); at != told_.end()) {
      at->second.erase(brick);
      if (at->second.empty()) told_.erase(at);
    }
  });
  revision_ = beliefs.revision();
}

// What it told before it began anew is void.
void ToldSurprises::forget(world::RobotId robot) {
  for (auto& [column, bricks] : told_)
    std::erase_if(bricks, [robot](const auto& brick) { return brick.first.first == robot; });
  std::erase_if(told_, [](const auto& column) { return column.second.empty(); });
}

void ToldSurprises::tell(world::RobotId robot, const world::CellIndex& cell, uint8_t steps) {
  told_[brickColumnOf(cell)][{robot, cell.z >> 4}][cell] = steps;
}

std::vector<uint8_t> ToldSurprises::of(std::span<const GlobalCell> cells) const {
  std::vector<uint8_t> steps(cells.size());
  const auto look = [&](const std::map<Brick, Told>& bricks) {
    for (const auto& [brick, told] : bricks) {
      for (const auto& [index, surprise] : told) {
        const auto cell = std::ranges::lower_bound(cells, index, {}, &GlobalCell::cell);
        if (cell != cells.end() && cell->cell == index && cell->robot == brick.first)
          steps[static_cast<size_t>(cell - cells.begin())] = surprise;
      }
    }
  };
  std::set<BrickColumn> columns;
  for (const GlobalCell& c : cells) columns.insert(brickColumnOf(c.cell));
  for (const BrickColumn& column : columns)
    if (const auto at = told_.find(column); at != told_.end()) look(at->second);
  return steps;
}

uint64_t ToldSurprises::hashOf(const BrickColumn& column) const {
  const auto at = told_.find(column);
  if (at == told_.end()) return 0;
  uint64_t sum = 0;
  for (const auto& [brick, told] : at->second) {
    for (const auto& [cell, surprise] : told)
      sum += cellHash(cell, brick.first, {}, 0) * (2 * uint64_t{surprise} + 1);
  }
  return mix64(sum);
}

}  // namespace shoal::mapping
