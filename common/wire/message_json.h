// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/wire/bytes.h"

namespace shoal::wire {

/// What our decoders make of a message, in the words of `shoal_reader.py --messages`: "channel", "kind", the
/// fields, and what the payload holds; or "channel" and "refused" with the reason.
nlohmann::json messageJson(const std::string& channel, std::span<const uint8_t> bytes);

}  // namespace shoal::wire
