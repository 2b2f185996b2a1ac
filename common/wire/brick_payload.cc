// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/demand.h"
#include "shoal/wire/cells_coder.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/payloads.h"

namespace shoal::wire {
namespace {

// Topics, then times, of the cells of a brick.
template <typename Coder>
bool codeColumns(Coder& coder, const Occupancy& occupancy, Palette& topics, Palette& times) {
  const auto neighbours = neighboursOf(occupancy);
  const auto size = [](const Palette& palette) { return static_cast<int32_t>(palette.values.size()); };
  return codePalette(coder, world::kMaxTopicId, kMaxBrickCells, topics.values) &&
         codeIndices(coder, neighbours, size(topics), Scale::kNames, topics.indices) &&
         codeTimes(coder, kMaxTimeUs, kMaxBrickCells, times.values) &&
         codeIndices(coder, neighbours, size(times), Scale::kOrder, times.indices) && !coder.overrun();
}

}  // namespace

Bytes encodeBrick(const mapping::BrickPart& brick) {
  Encoder encoder;
  const Occupancy occupancy = codeOccupancy(encoder, Occupancy::of(brick.cells));
  Palette topics = Palette::of(brick.cells, [](const auto& c) -> int64_t { return number(c.topic); });
  Palette times = Palette::of(brick.cells, [](const auto& c) { return c.seen.us; });
  SHOAL_DEMAND(codeColumns(encoder, occupancy, topics, times));
  return encoder.finish();
}

bool decodeBrick(std::span<const uint8_t> payload, const std::array<int32_t, 3>& index, int32_t num_cells,
                 mapping::BrickPart& brick) {
  Decoder decoder(payload);
  const Occupancy occupancy = codeOccupancy(decoder, {});
  if (occupancy.numCells() != num_cells) return false;
  Palette topics;
  Palette times;
  if (!codeColumns(decoder, occupancy, topics, times)) return false;
  const auto cells = occupancy.cells(index);
  for (size_t i = 0; i < cells.size(); ++i) {
    const int64_t topic = topics.values[static_cast<size_t>(topics.indices[i])];
    brick.cells.push_back({cells[i],
                           world::TopicId{static_cast<int32_t>(topic)},
                           {times.values[static_cast<size_t>(times.indices[i])]}});
  }
  return true;
}

Bytes encodeCertainty(const mapping::CertaintyPart& certainty) {
  Encoder encoder;
  const Occupancy occupancy = codeOccupancy(encoder, Occupancy::of(certainty.cells));
  std::vector<int32_t> steps;
  for (const auto& c : certainty.cells) steps.push_back(c.steps);
  SHOAL_DEMAND(codeLevels(encoder, neighboursOf(occupancy), mapping::kCertaintySteps + 1, steps));
  return encoder.finish();
}

bool decodeCertainty(std::span<const uint8_t> payload, const std::array<int32_t, 3>& index, int32_t num_cells,
                     mapping::CertaintyPart& certainty) {
  Decoder decoder(payload);
  const Occupancy occupancy = codeOccupancy(decoder, {});
  if (occupancy.numCells() != num_cells) return false;
  std::vector<int32_t> steps;
  if (!codeLevels(decoder, neighboursOf(occupancy), mapping::kCertaintySteps + 1, steps)) return false;
  const auto cells = occupancy.cells(index);
  for (size_t i = 0; i < cells.size(); ++i) {
    certainty.cells.push_back({cells[i], static_cast<uint8_t>(steps[i])});
  }
  return !decoder.overrun();
}

}  // namespace shoal::wire
