// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For this room's .cc files: the payloads of pieces. docs/wire.md describes them bit by bit. The contents
// encoded are valid (piece_codec checks); what is decoded is checked by piece_codec, except where noted.

#include <array>
#include <cstdint>
#include <span>

#include "shoal/mapping/piece.h"
#include "shoal/wire/bytes.h"

namespace shoal::wire {

Bytes encodeTopic(const mapping::TopicPart& topic);
Bytes encodeBrick(const mapping::BrickPart& brick);
Bytes encodeCertainty(const mapping::CertaintyPart& certainty);

/// All return false when the stream ends early or holds what cannot be. Memory: at most the caps of limits.h.
bool decodeTopic(std::span<const uint8_t> payload, int32_t num_words, mapping::TopicPart& topic);
bool decodeBrick(std::span<const uint8_t> payload, const std::array<int32_t, 3>& index, int32_t num_cells,
                 mapping::BrickPart& brick);
bool decodeCertainty(std::span<const uint8_t> payload, const std::array<int32_t, 3>& index, int32_t num_cells,
                     mapping::CertaintyPart& certainty);

}  // namespace shoal::wire
