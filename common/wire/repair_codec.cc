// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/repair_codec.h"

#include <optional>
#include <shoal/repair_t.hpp>
#include <shoal/request_t.hpp>

#include "shoal/wire/message.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::wire {
namespace {

constexpr size_t kOwnFieldsOffset = kFormatOffset + 1;  // what a message has beyond every message's front
constexpr size_t kTailBytes = 6;                        // checksum and n

std::optional<MessageKind> messageOf(uint8_t piece_kind) {
  switch (static_cast<mapping::PieceKind>(piece_kind)) {
    case mapping::PieceKind::kTopic:
      return MessageKind::kTopics;
    case mapping::PieceKind::kBrick:
      return MessageKind::kBrick;
    case mapping::PieceKind::kCertainty:
      return MessageKind::kCertainty;
    case mapping::PieceKind::kEdit:
      return MessageKind::kEdit;
    case mapping::PieceKind::kPicture:
      return MessageKind::kPicture;
    case mapping::PieceKind::kSettings:
      return MessageKind::kSettings;
  }
  return std::nullopt;
}

}  // namespace

Bytes encodeRepair(const mapping::Piece& piece, int32_t mission, world::Timestamp time) {
  const Bytes whole = encode(piece, mission, time);
  const size_t fixed = fixedBytesOf(kindOf(piece));
  repair_t message{};
  message.utime = time.us;
  message.mission = mission;
  message.piece_kind = static_cast<uint8_t>(piece.key.kind);
  const auto at = [&whole](size_t offset) { return whole.begin() + static_cast<ptrdiff_t>(offset); };
  Bytes payload(at(kOwnFieldsOffset), at(fixed - kTailBytes));
  payload.insert(payload.end(), at(fixed), whole.end());
  return checkedSize(pack(std::move(message), std::move(payload)), "repair");
}

Result<mapping::Piece> decodeRepair(std::span<const uint8_t> bytes) {
  const auto message = unpack<repair_t>(bytes);
  if (!message) return message.error();
  const auto kind = messageOf(message->piece_kind);
  if (!kind) return DecodeError::kBadField;
  const size_t own_fields = fixedBytesOf(*kind) - kTailBytes - kOwnFieldsOffset;
  const Bytes& payload = message->payload;
  if (payload.size() < own_fields) return DecodeError::kTooShort;
  Bytes whole;
  putBigEndian(whole, static_cast<uint64_t>(fingerprintOf(*kind)), 8);
  putBigEndian(whole, static_cast<uint64_t>(message->utime), 8);
  putBigEndian(whole, static_cast<uint64_t>(message->mission), 4);
  whole.push_back(kFormat);
  const auto own_end = payload.begin() + static_cast<ptrdiff_t>(own_fields);
  whole.insert(whole.end(), payload.begin(), own_end);
  putBigEndian(whole, 0, 2);
  putBigEndian(whole, payload.size() - own_fields, 4);
  whole.insert(whole.end(), own_end, payload.end());
  writeChecksum(whole, fixedBytesOf(*kind));
  auto pieces = decodePieces(*kind, whole);
  if (!pieces) return pieces.error();
  if (pieces->size() != 1) return DecodeError::kBadField;
  return pieces->front();
}

Bytes encodeRequest(std::span<const uint8_t> talk, int32_t mission, world::Timestamp time) {
  request_t message{};
  message.utime = time.us;
  message.mission = mission;
  return checkedSize(pack(std::move(message), Bytes(talk.begin(), talk.end())), "request");
}

Result<Bytes> decodeRequest(std::span<const uint8_t> bytes) {
  auto message = unpack<request_t>(bytes);
  if (!message) return message.error();
  return message->payload;
}

}  // namespace shoal::wire
