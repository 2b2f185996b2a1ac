// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/global_map.h"

#include <bit>

#include "shoal/random.h"

namespace shoal::mapping {

uint64_t GlobalMap::digest() const {
  uint64_t hash = 0;
  const auto add = [&hash](int64_t value) { hash = hashCombine(hash, static_cast<uint64_t>(value)); };
  for (const GlobalCell& c : cells) {
    add(c.cell.x);
    add(c.cell.y);
    add(c.cell.z);
    add(number(c.label));
    add(number(c.robot));
    add(c.seen.us);
    add(std::bit_cast<int32_t>(c.certainty));
  }
  for (const Correspondence& c : correspondences) {
    add(number(c.robot));
    add(number(c.topic));
    add(number(c.label));
  }
  return hash;
}

}  // namespace shoal::mapping
