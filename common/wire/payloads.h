// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For this room's .cc files: the payloads of pieces. docs/wire.md describes them bit by bit. The contents
// encoded are valid (piece_codec checks); what is decoded is checked by piece_codec, except where noted.

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/mapping/piece.h"
#include "shoal/wire/bytes.h"

namespace shoal::wire {

/// Topics of one robot and epoch with the same word groups, ascending by id, each id once, at most
/// kMaxTopicsPerMessage with kMaxWordsPerMessage words in all.
Bytes encodeTopics(std::span<const mapping::Piece* const> pieces);

/// Bricks of one robot and epoch, ascending by index, each index once, at most kMaxBricksPerMessage with
/// kMaxCellsPerMessage cells in all; `pieces` point to BrickPart, or all to CertaintyPart.
Bytes encodeBricks(std::span<const mapping::Piece* const> pieces);
Bytes encodeCertainties(std::span<const mapping::Piece* const> pieces);

/// All return false when the stream ends early or holds what cannot be. Memory: at most the caps of limits.h.

/// `pieces` holds the first, all of it that the message's fields say and an empty TopicPart; the others come
/// after it.
bool decodeTopics(std::span<const uint8_t> payload, int32_t num_words, std::vector<mapping::Piece>& pieces);

/// Fill in index, version's observation, part, num_parts and content of as many pieces as `pieces` has.
bool decodeBricks(std::span<const uint8_t> payload, std::span<mapping::Piece> pieces);
bool decodeCertainties(std::span<const uint8_t> payload, std::span<mapping::Piece> pieces);

}  // namespace shoal::wire
