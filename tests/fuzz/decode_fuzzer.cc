// SPDX-License-Identifier: BSD-3-Clause
// Any bytes, as any kind of message: every decoder returns, and what it accepts encodes to the same bytes.
// A fingerprint of ours picks the kind, else the first byte does. Fingerprint, length, format and checksum
// are put right for most inputs, so that the fuzzer gets past them.
//
//     fuzz_decode -max_total_time=60 -max_len=1391 $(mktemp -d) tests/data/wire
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>

#include "examples.h"
#include "shoal/wire/checksum.h"
#include "shoal/wire/message.h"
#include "shoal/wire/message_kind.h"

namespace {

using shoal::wire::Bytes;
using shoal::wire::MessageKind;

size_t documentedBytesOf(MessageKind kind) {
  for (const auto& example : shoal::wire::goldenExamples()) {
    if (example.kind != kind) continue;
    for (size_t fixed = 27; fixed <= example.bytes.size(); ++fixed) {  // where the length that fits stands
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
    for (size_t k = 0; k < fixed.size(); ++k) fixed[k] = documentedBytesOf(static_cast<MessageKind>(k));
    return fixed;
  }();
  if (size < 8) return 0;
  Bytes bytes(data, data + size);
  const auto known =
      shoal::wire::kindOf(static_cast<int64_t>(shoal::wire::bigEndian(std::span(bytes).first(8))));
  const MessageKind kind = known.value_or(static_cast<MessageKind>(data[0] % shoal::wire::kNumMessageKinds));
  const size_t fixed = kFixed[static_cast<size_t>(kind)];
  if (size % 8 != 0 && size >= fixed) {
    put(bytes, 0, static_cast<uint64_t>(shoal::wire::fingerprintOf(kind)), 8);
    put(bytes, fixed - 4, size - fixed, 4);
    bytes[shoal::wire::kFormatOffset] = shoal::wire::kFormat;
    shoal::wire::writeChecksum(bytes, fixed);
  }
  const Bytes again = shoal::wire::decodeAndEncode(kind, bytes);
  if (!again.empty() && again != bytes) std::abort();
  return 0;
}
