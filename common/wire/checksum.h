// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace shoal::wire {

/// The version byte stands behind fingerprint, utime and mission in every type.
inline constexpr size_t kFormatOffset = 20;

/// CRC-16/CCITT-FALSE (polynomial 0x1021, start 0xffff) of a message whose two checksum bytes count as 0.
/// They stand before the payload's length: at fixed - 6, where `fixed` counts the bytes before the payload.
/// Finds every single flipped bit and every burst of up to 16; it is no protection against malice.
uint16_t checksumOf(std::span<const uint8_t> message, size_t fixed);

void writeChecksum(std::span<uint8_t> message, size_t fixed);
bool hasRightChecksum(std::span<const uint8_t> message, size_t fixed);

}  // namespace shoal::wire
