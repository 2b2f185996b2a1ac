// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/bytes.h"

namespace shoal::wire {

void putVarint(Bytes& out, uint64_t value) {
  for (; value >= 0x80; value >>= 7) out.push_back(static_cast<uint8_t>(value | 0x80));
  out.push_back(static_cast<uint8_t>(value));
}

void putBigEndian(Bytes& out, uint64_t value, int num_bytes) {
  for (int shift = 8 * (num_bytes - 1); shift >= 0; shift -= 8)
    out.push_back(static_cast<uint8_t>(value >> shift));
}

uint8_t ByteReader::next() {
  if (bytes_.empty()) {
    failed_ = true;
    return 0;
  }
  const uint8_t byte = bytes_.front();
  bytes_ = bytes_.subspan(1);
  return byte;
}

uint64_t ByteReader::varint() {
  uint64_t value = 0;
  for (int shift = 0; shift < 64; shift += 7) {
    const uint64_t byte = next();
    value |= (byte & 0x7f) << shift;
    if (byte < 0x80) return failed_ ? 0 : value;
  }
  failed_ = true;
  return 0;
}

std::span<const uint8_t> ByteReader::take(uint64_t num_bytes) {
  if (failed_ || num_bytes > bytes_.size()) {
    failed_ = true;
    return {};
  }
  const auto taken = bytes_.first(static_cast<size_t>(num_bytes));
  bytes_ = bytes_.subspan(static_cast<size_t>(num_bytes));
  return taken;
}

uint64_t ByteReader::bigEndian(int num_bytes) {
  uint64_t value = 0;
  for (int i = 0; i < num_bytes; ++i) value = value << 8 | next();
  return failed_ ? 0 : value;
}

}  // namespace shoal::wire
