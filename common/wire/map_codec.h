// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shoal/mapping/global_map.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/result.h"

namespace shoal::wire {

/// Some cells of one fused map, all of one brick.
struct MapChunk {
  uint64_t map_digest = 0;                 ///< of the map; chunks of different maps never mix
  int32_t chunk = 0;                       ///< in [0, num_chunks)
  int32_t num_chunks = 1;                  ///< >= 1
  std::array<int32_t, 3> brick{};          ///< brick coordinates, see mapping::brickOf()
  std::vector<mapping::GlobalCell> cells;  ///< ascending by cell; empty only in an empty map's one chunk
  bool operator==(const MapChunk&) const = default;
};

/// Certainties travel in steps of 1/63: this rounds to the nearest, for numbers in [0, 1].
uint8_t certaintySteps(float certainty);

/// A fused map as messages of type map_t, each of at most `max_payload` bytes, brick by brick in ascending
/// order of brick. For the local bus. Lossless but for certainties, which are rounded to certaintySteps().
///
/// @param map   Cells ascending; they are what is encoded, correspondences and labels travel otherwise.
/// @param time  Mission time of sending, in [0, kMaxTimeUs].
/// @throws std::invalid_argument when cells are not ascending, a number is out of range, or `max_payload` is
///         too small for one cell.
std::vector<Bytes> encodeMap(const mapping::GlobalMap& map, uint64_t map_digest, int32_t mission,
                             world::Timestamp time, size_t max_payload = kMaxMessageBytes);

/// One chunk as it is.
/// @throws std::invalid_argument as above, and when it takes more than kMaxMessageBytes.
Bytes encode(const MapChunk& chunk, int32_t mission, world::Timestamp time);

/// The inverse of one message. Whatever the bytes are, it returns; what it returns encodes to the same bytes.
Result<MapChunk> decodeMap(std::span<const uint8_t> bytes);

}  // namespace shoal::wire
