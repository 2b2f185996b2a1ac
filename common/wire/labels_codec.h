// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "shoal/mapping/global_map.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/result.h"

namespace shoal::wire {

/// Some rows of the legend of one fused map.
struct LabelsChunk {
  uint64_t map_digest = 0;                    ///< of the map; chunks of different maps never mix
  int32_t chunk = 0;                          ///< in [0, num_chunks)
  int32_t num_chunks = 1;                     ///< in [1, kMaxChunks]
  std::vector<mapping::LabelSummary> labels;  ///< ascending by label, each once
  bool operator==(const LabelsChunk&) const = default;
};

/// True for names that may travel: at most 64 bytes of well-formed UTF-8 without control characters.
bool isName(std::string_view text);

/// The rows as messages of type labels_t, each of at most `max_payload` bytes; none is one message.
///
/// @param time  Mission time of sending, in [0, kMaxTimeUs].
/// @throws std::invalid_argument when rows are not ascending, a name is not isName(), a number is out of
///         range, a row joins more than 256 robots, or `max_payload` is too small for one row.
std::vector<Bytes> encodeLabels(std::span<const mapping::LabelSummary> labels, uint64_t map_digest,
                                int32_t mission, world::Timestamp time,
                                size_t max_payload = kMaxMessageBytes);

/// One chunk as it is.
/// @throws std::invalid_argument as above, and when it takes more than kMaxMessageBytes.
Bytes encode(const LabelsChunk& chunk, int32_t mission, world::Timestamp time);

/// The inverse of one message. Whatever the bytes are, it returns; what it returns encodes to the same bytes.
Result<LabelsChunk> decodeLabels(std::span<const uint8_t> bytes);

}  // namespace shoal::wire
