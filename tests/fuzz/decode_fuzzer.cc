// SPDX-License-Identifier: BSD-3-Clause
// Any bytes, as any kind of message: every decoder returns, and what it accepts encodes to the same bytes.
// The first byte picks the kind; fingerprint, length, format and checksum are then put right, most of the
// time, so that the fuzzer gets past them.
#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "examples.h"
#include "shoal/wire/checksum.h"
#include "shoal/wire/message_kind.h"

namespace {

using shoal::wire::Bytes;
using shoal::wire::MessageKind;

size_t fixedBytesOf(MessageKind kind) {
  for (const auto& example : shoal::wire::goldenExamples()) {
    if (example.kind != kind) continue;
    for (size_t fixed = 30; fixed < example.bytes.size(); ++fixed) {  // where the length that fits stands
      const auto length = std::span(example.bytes).subspan(fixed - 4, 4);
      if (shoal::wire::bigEndian(length) == example.bytes.size() - fixed) return fixed;
    }
  }
  std::abort();
}

void put(Bytes& bytes, size_t at, uint64_t value, int num_bytes) {
  for (int i = 0; i < num_bytes; ++i) {
    bytes[at + static_cast<size_t>(i)] = static_cast<uint8_t>(value >> 8 * (num_bytes - 1 - i));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const auto kFixed = [] {
    std::array<size_t, shoal::wire::kNumMessageKinds> fixed{};
    for (size_t k = 0; k < fixed.size(); ++k) fixed[k] = fixedBytesOf(static_cast<MessageKind>(k));
    return fixed;
  }();
  if (size < 1) return 0;
  const size_t k = (data[0] & 0x7f) % shoal::wire::kNumMessageKinds;
  const auto kind = static_cast<MessageKind>(k);
  Bytes bytes(data + 1, data + size);
  if ((data[0] & 0x80) == 0 && bytes.size() >= kFixed[k]) {
    put(bytes, 0, static_cast<uint64_t>(shoal::wire::fingerprintOf(kind)), 8);
    put(bytes, kFixed[k] - 4, bytes.size() - kFixed[k], 4);
    bytes[shoal::wire::kFormatOffset] = 1;
    shoal::wire::writeChecksum(bytes, kFixed[k]);
  }
  const Bytes again = shoal::wire::decodeAndEncode(kind, bytes);
  if (!again.empty() && again != bytes) std::abort();
  return 0;
}
