// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

#include "shoal/mapping/piece.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/result.h"

namespace shoal::wire {

/// A piece's message may be so long that a node of any name can say it again as a repair: a repair is one
/// byte longer, and its channel has at most 29 letters.
inline constexpr size_t kMaxRepairableBytes = maxPayload(29) - 1;

/// A piece as repair_t: what anybody who holds it may say, whoever made it. Its bytes are those of the
/// piece's own message, plus one.
/// @throws std::invalid_argument as encode(piece).
Bytes encodeRepair(const mapping::Piece& piece, int32_t mission, world::Timestamp time);

/// The inverse, as strict as decodePieces().
Result<mapping::Piece> decodeRepair(std::span<const uint8_t> bytes);

/// What was put into comms/repair_talk.h's bytes as request_t.
/// @throws std::invalid_argument when it is too long for a message.
Bytes encodeRequest(std::span<const uint8_t> talk, int32_t mission, world::Timestamp time);

/// The inverse: the talk's bytes, which are not looked at.
Result<Bytes> decodeRequest(std::span<const uint8_t> bytes);

}  // namespace shoal::wire
