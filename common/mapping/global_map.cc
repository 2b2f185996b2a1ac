// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/global_map.h"

#include <bit>

#include "shoal/random.h"

namespace shoal::mapping {

uint64_t cellHash(const world::CellIndex& cell, world::RobotId robot, world::Timestamp seen,
                  float certainty) {
  const auto pair = [](int32_t high, int32_t low) {
    return uint64_t{static_cast<uint32_t>(high)} << 32 | static_cast<uint32_t>(low);
  };
  uint64_t hash = hashCombine(0, pair(cell.x, cell.y));
  hash = hashCombine(hash, pair(cell.z, number(robot)));
  hash = hashCombine(hash, static_cast<uint64_t>(seen.us));
  return hashCombine(hash, pair(0, std::bit_cast<int32_t>(certainty)));
}

uint64_t labelFactor(world::GlobalLabel label) { return mix64(static_cast<uint32_t>(number(label))) | 1u; }

uint64_t mapDigest(uint64_t sum_of_cells, const std::vector<Correspondence>& correspondences) {
  uint64_t hash = sum_of_cells;
  const auto add = [&hash](int64_t value) { hash = hashCombine(hash, static_cast<uint64_t>(value)); };
  for (const Correspondence& c : correspondences) {
    add(number(c.robot));
    add(number(c.topic));
    add(number(c.label));
  }
  return hash;
}

uint64_t GlobalMap::digest() const {
  uint64_t sum = 0;
  for (const GlobalCell& c : cells)
    sum += cellHash(c.cell, c.robot, c.seen, c.certainty) * labelFactor(c.label);
  return mapDigest(sum, correspondences);
}

}  // namespace shoal::mapping
