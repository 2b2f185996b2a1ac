// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For this room's .cc files: edits, which piece_codec.cc hands on.

#include <span>

#include "shoal/mapping/piece.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/result.h"

namespace shoal::wire {

/// Why an edit may not travel; empty when it may.
std::string faultOf(const mapping::Edit& edit, const mapping::Piece& piece);

/// An edit without fault as edit_t.
Bytes encodeEdit(const mapping::Edit& edit, int32_t mission, world::Timestamp time);

/// The inverse, ranges not checked yet.
Result<mapping::Piece> decodeEdit(std::span<const uint8_t> bytes);

}  // namespace shoal::wire
