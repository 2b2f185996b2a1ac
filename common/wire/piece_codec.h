// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shoal/mapping/piece.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/result.h"

namespace shoal::wire {

/// What kind of message a piece travels in: its channel.
MessageKind kindOf(const mapping::Piece& piece);

/// Why a piece may not travel, e.g. "cells are not ascending"; empty when it may. The rules are those of
/// mapping/piece.h and the caps of limits.h. Costs a pass over the piece.
std::string fault(const mapping::Piece& piece);

/// A piece as a message of type topics_t, bricks_t, certainties_t, picture_t, settings_t or edit_t. Lossless;
/// equal pieces (mission, time) are equal bytes.
///
/// @param mission  Id of the mission.
/// @param time     Mission time of sending, in [0, kMaxTimeUs].
/// @throws std::invalid_argument naming the fault() of the piece, or its size when it is above
///         kMaxMessageBytes: cutToFit() first.
Bytes encode(const mapping::Piece& piece, int32_t mission, world::Timestamp time);

/// Bricks, or certainties, of one robot and epoch in one message, in any order, no brick twice: far fewer
/// bytes than one by one, since they share header, palette and models.
/// @throws std::invalid_argument as above, or saying why they cannot share a message.
Bytes encode(std::span<const mapping::Piece> pieces, int32_t mission, world::Timestamp time);

/// The same, of any size; nothing when they cannot share a message. The time of sending is 0.
std::optional<Bytes> encodeTogether(std::span<const mapping::Piece* const> pieces, int32_t mission);

/// Cuts a whole piece (part 0 of 1, of any size) into parts of at most `max_payload` encoded bytes.
///
/// A topic's words go by count, heaviest first and ties to the lower word, so that part 0 alone is the best
/// summary of its size; bricks and certainties are cut into runs of cells in canonical order. Deterministic.
/// Parts are filled by bisection: about 12 encodings a part, one when everything fits.
///
/// @throws std::invalid_argument when the piece is faulty or already a part, when not even one element fits
///         into `max_payload`, or when more than 255 parts would be needed. The last cannot happen to
///         vocabularies up to 65536 words and messages of kMaxMessageBytes: even 31 random bits a count
///         take 226 parts.
std::vector<mapping::Piece> cutToFit(const mapping::Piece& whole, size_t max_payload);

/// A part, and the message that encode() makes of it.
struct EncodedPart {
  mapping::Piece part;
  Bytes message;
};

/// cutToFit(), each part encoded with time of sending 0. Costs one encoding when the whole fits.
/// @throws std::invalid_argument as cutToFit().
std::vector<EncodedPart> encodeToFit(const mapping::Piece& whole, size_t max_payload, int32_t mission);

/// The inverse of encode(). Whatever the bytes are, it returns, within the memory of one message of valid
/// pieces, and what it returns encodes to the very same bytes.
///
/// @param kind  What the channel announced; another type is refused.
/// @returns the pieces in order of their keys, at least one.
Result<std::vector<mapping::Piece>> decodePieces(MessageKind kind, std::span<const uint8_t> bytes);

}  // namespace shoal::wire
