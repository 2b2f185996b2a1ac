// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/checksum.h"

#include <array>

namespace shoal::wire {
namespace {

constexpr std::array<uint16_t, 256> kTable = [] {
  std::array<uint16_t, 256> table{};
  for (unsigned i = 0; i < 256; ++i) {
    unsigned crc = i << 8;
    for (int bit = 0; bit < 8; ++bit) crc = (crc & 0x8000) != 0 ? crc << 1 ^ 0x1021 : crc << 1;
    table[i] = static_cast<uint16_t>(crc);
  }
  return table;
}();

}  // namespace

uint16_t checksumOf(std::span<const uint8_t> message, size_t fixed) {
  unsigned crc = 0xffff;
  for (size_t i = 0; i < message.size(); ++i) {
    const unsigned byte = i == fixed - 6 || i == fixed - 5 ? 0u : message[i];
    crc = (crc << 8 ^ kTable[(crc >> 8 ^ byte) & 0xff]) & 0xffff;
  }
  return static_cast<uint16_t>(crc);
}

void writeChecksum(std::span<uint8_t> message, size_t fixed) {
  const uint16_t crc = checksumOf(message, fixed);
  message[fixed - 6] = static_cast<uint8_t>(crc >> 8);
  message[fixed - 5] = static_cast<uint8_t>(crc);
}

bool hasRightChecksum(std::span<const uint8_t> message, size_t fixed) {
  return checksumOf(message, fixed) == (message[fixed - 6] << 8 | message[fixed - 5]);
}

}  // namespace shoal::wire
