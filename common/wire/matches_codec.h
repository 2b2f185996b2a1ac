// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shoal/mapping/global_map.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/result.h"

namespace shoal::wire {

/// A part of the list "this robot's topic is that label" of one fused map.
struct MatchesChunk {
  uint64_t map_digest = 0;                               ///< of the map; chunks of different maps never mix
  int32_t chunk = 0;                                     ///< in [0, num_chunks)
  int32_t num_chunks = 1;                                ///< in [1, kMaxChunks]
  std::vector<mapping::Correspondence> correspondences;  ///< ascending by robot, topic; each once
  bool operator==(const MatchesChunk&) const = default;
};

/// The list as messages of type matches_t, each of at most `max_payload` bytes. An empty list is one message:
/// listeners learn that there is nothing.
///
/// @param time  Mission time of sending, in [0, kMaxTimeUs].
/// @throws std::invalid_argument when the list is not strictly ascending by (robot, topic), an id is out of
///         range, or `max_payload` is too small for one entry.
std::vector<Bytes> encodeMatches(std::span<const mapping::Correspondence> correspondences,
                                 uint64_t map_digest, int32_t mission, world::Timestamp time,
                                 size_t max_payload = kMaxMessageBytes);

/// One chunk as it is.
/// @throws std::invalid_argument as above, and when it takes more than kMaxMessageBytes.
Bytes encode(const MatchesChunk& chunk, int32_t mission, world::Timestamp time);

/// The inverse of one message. Whatever the bytes are, it returns; what it returns encodes to the same bytes.
Result<MatchesChunk> decodeMatches(std::span<const uint8_t> bytes);

}  // namespace shoal::wire
