// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/map_codec.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <shoal/map_t.hpp>
#include <stdexcept>
#include <string>

#include "shoal/demand.h"
#include "shoal/mapping/piece.h"
#include "shoal/wire/cells_coder.h"
#include "shoal/wire/cut.h"
#include "shoal/wire/message.h"

namespace shoal::wire {
namespace {

using mapping::GlobalCell;
using mapping::kCertaintySteps;

std::string faultOf(std::span<const GlobalCell> cells) {
  for (size_t i = 0; i < cells.size(); ++i) {
    const GlobalCell& c = cells[i];
    if (i > 0 && !(cells[i - 1].cell < c.cell)) return "cells are not ascending";
    if (number(c.label) < 0 || number(c.label) > kMaxLabel) return "labels lie in [0, 99999999]";
    if (number(c.robot) < 0 || number(c.robot) > kMaxRobotNumber) return "robot numbers lie in [0, 9999]";
    if (!isTime(c.seen)) return "a time last seen is out of range";
    if (!(c.certainty >= 0 && c.certainty <= 1)) return "certainties lie in [0, 1]";
  }
  return {};
}

std::string fault(const MapChunk& chunk) {
  if (chunk.num_chunks < 1 || chunk.chunk < 0 || chunk.chunk >= chunk.num_chunks)
    return "chunks are numbered from 0";
  if (!isBrick(chunk.brick)) return "brick coordinates lie in [-2^27, 2^27)";
  if (chunk.cells.empty() && (chunk.num_chunks != 1 || chunk.brick != std::array<int32_t, 3>{})) {
    return "a chunk is empty, and not the only one";
  }
  for (const GlobalCell& c : chunk.cells) {
    if (mapping::brickOf(c.cell) != chunk.brick) return "a cell lies outside the brick";
  }
  return faultOf(chunk.cells);
}

struct Columns {
  Palette labels, robots, times, steps;
};

template <typename Coder>
bool codeColumns(Coder& coder, const CellField& field, Columns& columns) {
  auto& [labels, robots, times, steps] = columns;
  return codePalette(coder, kMaxLabel, kMaxBrickCells, labels.values) &&
         codeIndices(coder, field, labels.size(), Scale::kNames, labels.indices) &&
         codePalette(coder, kMaxRobotNumber, kMaxBrickCells, robots.values) &&
         codeIndices(coder, field, robots.size(), Scale::kNames, robots.indices) &&
         codeTimes(coder, kMaxTimeUs, kMaxBrickCells, times.values) &&
         codeIndices(coder, field, times.size(), Scale::kOrder, times.indices) &&
         codePalette(coder, kCertaintySteps, kCertaintySteps + 1, steps.values) &&
         codeIndices(coder, field, steps.size(), Scale::kNames, steps.indices) && !coder.overrun();
}

Bytes encodeValid(const MapChunk& chunk, int32_t mission, world::Timestamp time) {
  map_t message{};
  message.utime = time.us;
  message.mission = mission;
  message.map_digest = static_cast<int64_t>(chunk.map_digest);
  message.chunk = chunk.chunk;
  message.num_chunks = chunk.num_chunks;
  message.brick_x = chunk.brick[0];
  message.brick_y = chunk.brick[1];
  message.brick_z = chunk.brick[2];
  message.fused_cells = static_cast<int16_t>(chunk.cells.size());
  Encoder encoder;
  if (!chunk.cells.empty()) {
    CellField field;
    SHOAL_DEMAND(GeometryCoder().code(encoder, chunk.brick, Occupancy::of(chunk.cells), field));
    Columns columns{
        Palette::of(chunk.cells, [](const GlobalCell& c) -> int64_t { return number(c.label); }),
        Palette::of(chunk.cells, [](const GlobalCell& c) -> int64_t { return number(c.robot); }),
        Palette::of(chunk.cells, [](const GlobalCell& c) { return c.seen.us; }),
        Palette::of(chunk.cells, [](const GlobalCell& c) -> int64_t { return certaintySteps(c.certainty); })};
    SHOAL_DEMAND(codeColumns(encoder, field, columns));
  }
  return pack(std::move(message), encoder.finish());
}

bool decodeCells(std::span<const uint8_t> payload, int32_t num_cells, MapChunk& chunk) {
  if (num_cells == 0) return true;
  Decoder decoder(payload);
  CellField field;
  if (!GeometryCoder().code(decoder, chunk.brick, {}, field)) return false;
  if (std::ssize(field.cells()) != num_cells) return false;
  Columns columns;
  if (!codeColumns(decoder, field, columns)) return false;
  for (size_t i = 0; i < field.cells().size(); ++i) {
    chunk.cells.push_back({field.cells()[i],
                           world::GlobalLabel{static_cast<int32_t>(columns.labels.at(i))},
                           world::RobotId{static_cast<int32_t>(columns.robots.at(i))},
                           {columns.times.at(i)},
                           static_cast<float>(columns.steps.at(i)) / static_cast<float>(kCertaintySteps)});
  }
  return true;
}

}  // namespace

uint8_t certaintySteps(float certainty) {
  return static_cast<uint8_t>(std::floor(certainty * static_cast<float>(kCertaintySteps) + 0.5f));
}

std::vector<Bytes> encodeMap(const mapping::GlobalMap& map, uint64_t map_digest, int32_t mission,
                             world::Timestamp time, size_t max_payload) {
  if (!isTime(time)) throw std::invalid_argument("map: time of sending is out of range");
  if (const std::string why = faultOf(map.cells); !why.empty()) throw std::invalid_argument("map: " + why);
  max_payload = std::min(max_payload, kMaxMessageBytes);
  std::vector<GlobalCell> cells = map.cells;  // by brick; in canonical order within each
  std::stable_sort(cells.begin(), cells.end(), [](const GlobalCell& a, const GlobalCell& b) {
    return mapping::brickOf(a.cell) < mapping::brickOf(b.cell);
  });
  std::vector<MapChunk> chunks;
  for (size_t i = 0; i < cells.size();) {
    const auto brick = mapping::brickOf(cells[i].cell);
    size_t end = i;
    while (end < cells.size() && mapping::brickOf(cells[end].cell) == brick) ++end;
    const auto make = [&](size_t from, size_t to) {
      const auto run = std::span(cells).subspan(i + from, to - from);
      return MapChunk{map_digest, 0, 1, brick, {run.begin(), run.end()}};
    };
    for (const auto& [from, to] : cutRuns(end - i, kMaxBrickCells, [&](size_t from_cell, size_t to_cell) {
           return encodeValid(make(from_cell, to_cell), mission, time).size() <= max_payload;
         })) {
      chunks.push_back(make(from, to));
    }
    i = end;
  }
  if (chunks.empty()) chunks.push_back({map_digest, 0, 1, {}, {}});
  if (chunks.size() > std::numeric_limits<int32_t>::max())
    throw std::invalid_argument("map: too many chunks");
  std::vector<Bytes> messages;
  for (MapChunk& chunk : chunks) {
    chunk.chunk = static_cast<int32_t>(messages.size());
    chunk.num_chunks = static_cast<int32_t>(chunks.size());
    messages.push_back(encodeValid(chunk, mission, time));
  }
  return messages;
}

Bytes encode(const MapChunk& chunk, int32_t mission, world::Timestamp time) {
  if (!isTime(time)) throw std::invalid_argument("map: time of sending is out of range");
  if (const std::string why = fault(chunk); !why.empty()) throw std::invalid_argument("map: " + why);
  return checkedSize(encodeValid(chunk, mission, time), "map");
}

Result<MapChunk> decodeMap(std::span<const uint8_t> bytes) {
  const auto message = unpack<map_t>(bytes);
  if (!message) return message.error();
  const map_t& m = *message;
  MapChunk chunk{
      static_cast<uint64_t>(m.map_digest), m.chunk, m.num_chunks, {m.brick_x, m.brick_y, m.brick_z}, {}};
  if (m.fused_cells < 0 || m.fused_cells > kMaxBrickCells || !isBrick(chunk.brick))
    return DecodeError::kBadField;
  if (!decodeCells(m.payload, m.fused_cells, chunk)) return DecodeError::kBadPayload;
  if (!fault(chunk).empty()) return DecodeError::kBadField;
  const Bytes again = encodeValid(chunk, m.mission, {m.utime});
  if (!std::equal(again.begin(), again.end(), bytes.begin(), bytes.end())) return DecodeError::kNotCanonical;
  return chunk;
}

}  // namespace shoal::wire
