// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For this room's .cc files: a layer of an example picture as a message of type picture_t.

#include <cstdint>
#include <span>
#include <string>

#include "shoal/mapping/piece.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/result.h"

namespace shoal::wire {

/// What keeps a picture from travelling beyond what is wrong with any piece; empty when nothing does. The
/// layer itself may be any bytes: it is opaque until somebody looks.
std::string faultOf(const mapping::PicturePart& picture, const mapping::Piece& piece);

/// The piece is without fault.
Bytes encodePictureMessage(const mapping::Piece& piece, int32_t mission, world::Timestamp time);

/// Fields are checked by fault() of the piece, except for the length of the layer.
Result<mapping::Piece> decodePictureMessage(std::span<const uint8_t> bytes);

}  // namespace shoal::wire
