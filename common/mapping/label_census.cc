// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/label_census.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "shoal/mapping/piece.h"

namespace shoal::mapping {

LabelCensus censusOf(std::span<const GlobalCell> cells) {
  struct Counting {
    LabelCount count;
    std::pair<int32_t, int32_t> column;  // the last that was counted
  };
  std::map<world::GlobalLabel, Counting> labels;
  Counting* at = nullptr;
  world::GlobalLabel last{};
  for (const GlobalCell& c : cells) {
    const std::pair column(c.cell.x, c.cell.y);
    if (at == nullptr || c.label != last) {
      at = &labels.try_emplace(c.label, Counting{{.columns = 0, .last_seen = c.seen}, {}}).first->second;
      last = c.label;
    }
    if (at->count.columns == 0 || at->column != column) ++at->count.columns;
    at->column = column;
    at->count.last_seen = std::max(at->count.last_seen, c.seen);
    at->count.certainty += std::lround(c.certainty * static_cast<float>(kCertaintySteps));
    at->count.sure += c.certainty > 0;
  }
  LabelCensus census;
  for (const auto& [label, counting] : labels) census.emplace_hint(census.end(), label, counting.count);
  return census;
}

void add(LabelCensus& sum, const LabelCensus& part) {
  for (const auto& [label, count] : part) {
    const auto [known, is_new] = sum.try_emplace(label, count);
    if (is_new) continue;
    known->second.columns += count.columns;
    known->second.last_seen = std::max(known->second.last_seen, count.last_seen);
    known->second.certainty += count.certainty;
    known->second.sure += count.sure;
  }
}

}  // namespace shoal::mapping
