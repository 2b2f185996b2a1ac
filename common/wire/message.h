// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For this room's .cc files: what all messages have in common. It needs a generated type.

#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <utility>

#include "shoal/demand.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/checksum.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/result.h"

namespace shoal::wire {

/// The payload version this build writes and reads.
inline constexpr uint8_t kFormat = 3;

/// Bytes of a message before its payload, fingerprint included.
template <typename Message>
size_t fixedBytes() {
  Message message{};
  return static_cast<size_t>(message.getEncodedSize());
}

/// Fills in format, length and checksum, and encodes.
template <typename Message>
Bytes pack(Message message, Bytes payload) {
  message.format = kFormat;
  message.checksum = 0;
  message.n = static_cast<int32_t>(payload.size());
  message.payload = std::move(payload);
  const int size = message.getEncodedSize();
  Bytes bytes(static_cast<size_t>(size));
  SHOAL_DEMAND(message.encode(bytes.data(), 0, size) == size);
  writeChecksum(bytes, fixedBytes<Message>());
  return bytes;
}

/// Everything that can be checked without knowing what the message means, in an order in which no step can
/// be hurt by what a later one would find; no allocation before the length is known to be right.
template <typename Message>
Result<Message> unpack(std::span<const uint8_t> bytes) {
  const size_t fixed = fixedBytes<Message>();
  if (bytes.size() > kMaxMessageBytes) return DecodeError::kTooLong;
  if (bytes.size() < 8) return DecodeError::kTooShort;
  if (static_cast<int64_t>(bigEndian(bytes.first(8))) != Message::getHash()) return DecodeError::kWrongType;
  if (bytes.size() < fixed) return DecodeError::kTooShort;
  if (const auto header = peek(bytes); !header) return header.error();
  const uint64_t declared = bigEndian(bytes.subspan(fixed - 4, 4));
  if (declared > bytes.size() - fixed) return DecodeError::kBadLength;  // negative ones too
  if (declared < bytes.size() - fixed) return DecodeError::kTrailingBytes;
  if (bytes[kFormatOffset] != kFormat) return DecodeError::kUnknownFormat;
  if (!hasRightChecksum(bytes, fixed)) return DecodeError::kChecksum;
  try {
    Message message{};
    const int size = static_cast<int>(bytes.size());
    if (message.decode(bytes.data(), 0, size) != size) return DecodeError::kUndecodable;
    return message;
  } catch (const std::exception&) {
    return DecodeError::kUndecodable;
  }
}

/// Throws std::invalid_argument when `bytes` is more than one message may have.
Bytes checkedSize(Bytes bytes, const char* what);

}  // namespace shoal::wire
