// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/message_kind.h"

#include "shoal/wire/checksum.h"

#include <shoal/bricks_t.hpp>
#include <shoal/certainties_t.hpp>
#include <shoal/edit_t.hpp>
#include <shoal/heartbeat_t.hpp>
#include <shoal/labels_t.hpp>
#include <shoal/map_t.hpp>
#include <shoal/matches_t.hpp>
#include <shoal/picture_t.hpp>
#include <shoal/repair_t.hpp>
#include <shoal/request_t.hpp>
#include <shoal/settings_t.hpp>
#include <shoal/topics_t.hpp>

#include "shoal/wire/bytes.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/message.h"

namespace shoal::wire {

std::optional<MessageKind> parseChannelKind(std::string_view text) {
  for (size_t k = 0; k < kNumMessageKinds; ++k) {
    if (kChannelKinds[k] == text) return static_cast<MessageKind>(k);
  }
  return std::nullopt;
}

size_t fixedBytesOf(MessageKind kind) {
  switch (kind) {
    case MessageKind::kHeartbeat:
      return fixedBytes<heartbeat_t>();
    case MessageKind::kTopics:
      return fixedBytes<topics_t>();
    case MessageKind::kBrick:
      return fixedBytes<bricks_t>();
    case MessageKind::kCertainty:
      return fixedBytes<certainties_t>();
    case MessageKind::kMatches:
      return fixedBytes<matches_t>();
    case MessageKind::kLabels:
      return fixedBytes<labels_t>();
    case MessageKind::kMap:
      return fixedBytes<map_t>();
    case MessageKind::kEdit:
      return fixedBytes<edit_t>();
    case MessageKind::kRequest:
      return fixedBytes<request_t>();
    case MessageKind::kRepair:
      return fixedBytes<repair_t>();
    case MessageKind::kPicture:
      return fixedBytes<picture_t>();
    case MessageKind::kSettings:
      return fixedBytes<settings_t>();
  }
  SHOAL_DEMAND(false);
  return 0;
}

int64_t fingerprintOf(MessageKind kind) {
  switch (kind) {
    case MessageKind::kHeartbeat:
      return heartbeat_t::getHash();
    case MessageKind::kTopics:
      return topics_t::getHash();
    case MessageKind::kBrick:
      return bricks_t::getHash();
    case MessageKind::kCertainty:
      return certainties_t::getHash();
    case MessageKind::kMatches:
      return matches_t::getHash();
    case MessageKind::kLabels:
      return labels_t::getHash();
    case MessageKind::kMap:
      return map_t::getHash();
    case MessageKind::kEdit:
      return edit_t::getHash();
    case MessageKind::kRequest:
      return request_t::getHash();
    case MessageKind::kRepair:
      return repair_t::getHash();
    case MessageKind::kPicture:
      return picture_t::getHash();
    case MessageKind::kSettings:
      return settings_t::getHash();
  }
  SHOAL_DEMAND(false);
  return 0;
}

std::optional<MessageKind> kindOf(int64_t fingerprint) {
  for (size_t k = 0; k < kNumMessageKinds; ++k) {
    if (fingerprintOf(static_cast<MessageKind>(k)) == fingerprint) return static_cast<MessageKind>(k);
  }
  return std::nullopt;
}

Result<Header> peek(std::span<const uint8_t> bytes) {
  if (bytes.size() < 20) return DecodeError::kTooShort;
  if (bytes.size() > kMaxMessageBytes) return DecodeError::kTooLong;
  const auto kind = kindOf(static_cast<int64_t>(bigEndian(bytes.first(8))));
  if (!kind) return DecodeError::kWrongType;
  const auto us = static_cast<int64_t>(bigEndian(bytes.subspan(8, 8)));
  if (us < 0 || us > kMaxTimeUs) return DecodeError::kBadField;
  return Header{*kind, {us}, static_cast<int32_t>(bigEndian(bytes.subspan(16, 4)))};
}

Result<size_t> bytesBehind(std::span<const uint8_t> bytes) {
  const auto header = peek(bytes);
  if (!header) return header.error();
  const size_t fixed = fixedBytesOf(header->kind);
  if (bytes.size() < fixed) return DecodeError::kTooShort;
  const uint64_t declared = bigEndian(bytes.subspan(fixed - 4, 4));
  if (declared > bytes.size() - fixed) return DecodeError::kBadLength;  // negative ones too
  return static_cast<size_t>(bytes.size() - fixed - declared);
}

void stampTime(std::span<uint8_t> message, world::Timestamp time) {
  const auto header = peek(message);
  SHOAL_DEMAND(header.ok() && time.us >= 0 && time.us <= kMaxTimeUs);
  for (size_t i = 0; i < 8; ++i) message[8 + i] = static_cast<uint8_t>(time.us >> (56 - 8 * i));
  writeChecksum(message, fixedBytesOf(header->kind));
}

}  // namespace shoal::wire
