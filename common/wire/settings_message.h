// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For this room's .cc files: a robot's settings as a message of type settings_t.

#include <cstdint>
#include <span>
#include <string>

#include "shoal/mapping/piece.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/result.h"

namespace shoal::wire {

/// What keeps settings from travelling beyond what is wrong with any piece; empty when nothing does.
std::string faultOf(const mapping::SettingsPart& settings, const mapping::Piece& piece);

/// The piece is without fault.
Bytes encodeSettingsMessage(const mapping::Piece& piece, int32_t mission, world::Timestamp time);

/// Fields are checked by fault() of the piece.
Result<mapping::Piece> decodeSettingsMessage(std::span<const uint8_t> bytes);

}  // namespace shoal::wire
