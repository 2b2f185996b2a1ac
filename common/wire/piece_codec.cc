// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/piece_codec.h"

#include <algorithm>
#include <numeric>
#include <shoal/brick_t.hpp>
#include <shoal/certainty_t.hpp>
#include <shoal/topics_t.hpp>
#include <stdexcept>

#include "shoal/wire/cut.h"
#include "shoal/wire/edit_message.h"
#include "shoal/wire/message.h"
#include "shoal/wire/payloads.h"
#include "shoal/wire/picture_message.h"

namespace shoal::wire {
namespace {

using mapping::BrickPart;
using mapping::CertaintyPart;
using mapping::Piece;
using mapping::PieceKind;
using mapping::TopicPart;

bool isTime(world::Timestamp time) { return time.us >= 0 && time.us <= kMaxTimeUs; }

template <typename Cells>
std::string faultOfCells(const Cells& cells, const std::array<int32_t, 3>& brick) {
  if (cells.empty()) return "it has no cells";
  for (size_t i = 0; i < cells.size(); ++i) {
    if (mapping::brickOf(cells[i].cell) != brick) return "a cell lies outside the brick";
    if (i > 0 && !(cells[i - 1].cell < cells[i].cell)) return "cells are not ascending";
  }
  return {};
}

std::string faultOf(const TopicPart& topic, const mapping::PieceKey& key) {
  if (key.kind != PieceKind::kTopic) return "key and content are of different kinds";
  if (key.index[0] < 0 || key.index[0] > world::kMaxTopicId) return "topic ids lie in [0, 9999]";
  if (key.index[1] != 0 || key.index[2] != 0) return "a topic's index is {id, 0, 0}";
  if (!isTime(topic.created)) return "the creation time is out of range";
  if (topic.weight < 0 || topic.weight > kMaxTimeUs) return "the weight is negative";
  if (topic.weight == 0 && !topic.words.empty()) return "a retired topic (weight 0) has no words";
  if (topic.group_sizes.empty() || topic.group_sizes.size() > kMaxWordGroups) return "1 to 64 word groups";
  int64_t vocabulary = 0;
  for (const int32_t size : topic.group_sizes) {
    if (size <= 0) return "a word group is empty";
    vocabulary += size;
  }
  if (vocabulary > kMaxVocabulary) return "the vocabulary is above 1048576 words";
  for (size_t i = 0; i < topic.words.size(); ++i) {
    if (topic.words[i].word < 0 || topic.words[i].word >= vocabulary)
      return "a word is not in the vocabulary";
    if (topic.words[i].count <= 0) return "a count is not > 0";
    if (i > 0 && topic.words[i - 1].word >= topic.words[i].word) return "words are not ascending";
  }
  return {};
}

std::string faultOf(const BrickPart& brick, const mapping::PieceKey& key) {
  if (key.kind != PieceKind::kBrick) return "key and content are of different kinds";
  for (const auto& c : brick.cells) {
    if (number(c.topic) < 0 || number(c.topic) > world::kMaxTopicId) return "topic ids lie in [0, 9999]";
    if (!isTime(c.seen)) return "a time last seen is out of range";
  }
  return faultOfCells(brick.cells, key.index);
}

std::string faultOf(const CertaintyPart& certainty, const mapping::PieceKey& key) {
  if (key.kind != PieceKind::kCertainty) return "key and content are of different kinds";
  for (const auto& c : certainty.cells) {
    if (c.steps > mapping::kCertaintySteps) return "certainty steps lie in [0, 63]";
  }
  return faultOfCells(certainty.cells, key.index);
}

// What the three types have in common.
template <typename Message>
Message frame(const Piece& piece, int32_t mission, world::Timestamp time) {
  Message message{};
  message.utime = time.us;
  message.mission = mission;
  message.part = static_cast<uint8_t>(piece.part);
  message.num_parts = static_cast<uint8_t>(piece.num_parts);
  message.robot = static_cast<int16_t>(number(piece.key.robot));
  message.epoch = piece.version.epoch;
  message.observation = piece.version.observation;
  return message;
}

template <typename Message>
void setBrick(Message& message, const Piece& piece) {
  message.brick_x = piece.key.index[0];
  message.brick_y = piece.key.index[1];
  message.brick_z = piece.key.index[2];
}

// Of any size. The piece is without fault.
Bytes encodeValid(const Piece& piece, int32_t mission, world::Timestamp time) {
  if (const auto* topic = std::get_if<TopicPart>(&piece.content)) {
    auto message = frame<topics_t>(piece, mission, time);
    message.topic = static_cast<int16_t>(piece.key.index[0]);
    message.num_words = static_cast<int32_t>(topic->words.size());
    return pack(std::move(message), encodeTopic(*topic));
  }
  if (const auto* brick = std::get_if<BrickPart>(&piece.content)) {
    auto message = frame<brick_t>(piece, mission, time);
    setBrick(message, piece);
    message.cells = static_cast<int16_t>(brick->cells.size());
    return pack(std::move(message), encodeBrick(*brick));
  }
  if (const auto* edit = std::get_if<mapping::Edit>(&piece.content)) return encodeEdit(*edit, mission, time);
  if (std::holds_alternative<mapping::PicturePart>(piece.content)) {
    return encodePictureMessage(piece, mission, time);
  }
  const auto& certainty = std::get<CertaintyPart>(piece.content);
  auto message = frame<certainty_t>(piece, mission, time);
  setBrick(message, piece);
  message.certainties = static_cast<int16_t>(certainty.cells.size());
  return pack(std::move(message), encodeCertainty(certainty));
}

template <typename Message>
Piece unframe(const Message& message, PieceKind kind) {
  Piece piece;
  piece.key.robot = world::RobotId{message.robot};
  piece.key.kind = kind;
  piece.version = {message.epoch, message.observation};
  piece.part = message.part;
  piece.num_parts = message.num_parts;
  return piece;
}

Result<Piece> decodeTopics(std::span<const uint8_t> bytes) {
  const auto message = unpack<topics_t>(bytes);
  if (!message) return message.error();
  if (message->num_words < 0 || message->num_words > kMaxWordsPerPart) return DecodeError::kBadField;
  Piece piece = unframe(*message, PieceKind::kTopic);
  piece.key.index = {message->topic, 0, 0};
  TopicPart topic;
  if (!decodeTopic(message->payload, message->num_words, topic)) return DecodeError::kBadPayload;
  piece.content = std::move(topic);
  return piece;
}

template <typename Message, typename Part>
Result<Piece> decodeCells(std::span<const uint8_t> bytes, PieceKind kind, int16_t Message::*count,
                          bool (*decode)(std::span<const uint8_t>, const std::array<int32_t, 3>&, int32_t,
                                         Part&)) {
  const auto message = unpack<Message>(bytes);
  if (!message) return message.error();
  const int32_t cells = (*message).*count;
  if (cells < 1 || cells > kMaxBrickCells) return DecodeError::kBadField;
  Piece piece = unframe(*message, kind);
  piece.key.index = {message->brick_x, message->brick_y, message->brick_z};
  if (!isBrick(piece.key.index)) return DecodeError::kBadField;
  Part part;
  if (!decode(message->payload, piece.key.index, cells, part)) return DecodeError::kBadPayload;
  piece.content = std::move(part);
  return piece;
}

// The part of `whole` whose elements are those of `words` in [begin, end), words ascending again.
TopicPart partOf(const TopicPart& whole, const std::vector<world::WordCount>& words, size_t begin,
                 size_t end) {
  TopicPart part{whole.created, whole.weight, whole.group_sizes, {}};
  part.words.assign(words.begin() + static_cast<ptrdiff_t>(begin),
                    words.begin() + static_cast<ptrdiff_t>(end));
  std::sort(part.words.begin(), part.words.end());
  return part;
}

}  // namespace

MessageKind kindOf(const Piece& piece) {
  switch (piece.content.index()) {
    case 0:
      return MessageKind::kTopics;
    case 1:
      return MessageKind::kBrick;
    case 2:
      return MessageKind::kCertainty;
    case 3:
      return MessageKind::kEdit;
    default:
      return MessageKind::kPicture;
  }
}

std::string fault(const Piece& piece) {
  if (const auto* edit = std::get_if<mapping::Edit>(&piece.content)) return faultOf(*edit, piece);
  const int32_t robot = number(piece.key.robot);
  if (robot < 0 || robot > kMaxRobotNumber) return "robot numbers lie in [0, 9999]";
  if (piece.version.epoch < 0 || piece.version.observation < 0) return "versions are not negative";
  if (piece.num_parts < 1 || piece.num_parts > kMaxParts) return "1 to 255 parts";
  if (piece.part < 0 || piece.part >= piece.num_parts) return "parts are numbered from 0 to num_parts - 1";
  if (const auto* topic = std::get_if<TopicPart>(&piece.content)) return faultOf(*topic, piece.key);
  if (const auto* brick = std::get_if<BrickPart>(&piece.content)) return faultOf(*brick, piece.key);
  if (const auto* picture = std::get_if<mapping::PicturePart>(&piece.content))
    return faultOf(*picture, piece);
  return faultOf(std::get<CertaintyPart>(piece.content), piece.key);
}

Bytes encode(const Piece& piece, int32_t mission, world::Timestamp time) {
  if (!isTime(time))
    throw std::invalid_argument("time of sending out of range: " + std::to_string(time.us) + " us");
  if (const std::string why = fault(piece); !why.empty()) throw std::invalid_argument("piece: " + why);
  const auto* topic = std::get_if<TopicPart>(&piece.content);
  if (topic != nullptr && topic->words.size() > kMaxWordsPerPart) {
    throw std::invalid_argument("piece: more than 65536 words in a part: cut it to fit first");
  }
  return checkedSize(encodeValid(piece, mission, time), "piece");
}

std::vector<Piece> cutToFit(const Piece& whole, size_t max_payload) {
  if (const std::string why = fault(whole); !why.empty()) throw std::invalid_argument("piece: " + why);
  if (std::holds_alternative<mapping::Edit>(whole.content)) return {whole};         // always small
  if (std::holds_alternative<mapping::PicturePart>(whole.content)) return {whole};  // cut into layers already
  if (whole.num_parts != 1) throw std::invalid_argument("piece: it is a part already");
  const auto cut = [&](const auto& part, size_t count, size_t max_run) {
    const auto make = [&](size_t begin, size_t end) {
      Piece piece{whole.key, whole.version, 0, 1, {}};
      piece.content = part(begin, end);
      return piece;
    };
    const auto runs = cutRuns(count, max_run, [&](size_t begin, size_t end) {
      return encodeValid(make(begin, end), 0, {}).size() <= max_payload;
    });
    if (runs.size() > static_cast<size_t>(kMaxParts)) {
      throw std::invalid_argument("piece: " + std::to_string(runs.size()) + " parts of at most " +
                                  std::to_string(max_payload) + " bytes needed, at most 255 are allowed");
    }
    std::vector<Piece> pieces;
    for (const auto& [begin, end] : runs) {
      pieces.push_back(make(begin, end));
      pieces.back().part = static_cast<int32_t>(pieces.size()) - 1;
      pieces.back().num_parts = static_cast<int32_t>(runs.size());
    }
    return pieces;
  };
  if (const auto* topic = std::get_if<TopicPart>(&whole.content)) {
    std::vector<world::WordCount> ranked = topic->words;
    std::sort(ranked.begin(), ranked.end(), [](const auto& a, const auto& b) {
      return a.count != b.count ? a.count > b.count : a.word < b.word;
    });
    return cut([&](size_t begin, size_t end) { return partOf(*topic, ranked, begin, end); }, ranked.size(),
               kMaxWordsPerPart);
  }
  const auto run = [](const auto& content) {
    return [&content](size_t begin, size_t end) {
      auto part = content;
      part.cells.assign(content.cells.begin() + static_cast<ptrdiff_t>(begin),
                        content.cells.begin() + static_cast<ptrdiff_t>(end));
      return part;
    };
  };
  if (const auto* brick = std::get_if<BrickPart>(&whole.content)) {
    return cut(run(*brick), brick->cells.size(), kMaxBrickCells);
  }
  const auto& certainty = std::get<CertaintyPart>(whole.content);
  return cut(run(certainty), certainty.cells.size(), kMaxBrickCells);
}

Result<Piece> decodePiece(MessageKind kind, std::span<const uint8_t> bytes) {
  auto decoded = [&]() -> Result<Piece> {
    switch (kind) {
      case MessageKind::kTopics:
        return decodeTopics(bytes);
      case MessageKind::kBrick:
        return decodeCells<brick_t, BrickPart>(bytes, PieceKind::kBrick, &brick_t::cells, decodeBrick);
      case MessageKind::kCertainty:
        return decodeCells<certainty_t, CertaintyPart>(bytes, PieceKind::kCertainty,
                                                       &certainty_t::certainties, decodeCertainty);
      case MessageKind::kEdit:
        return decodeEdit(bytes);
      case MessageKind::kPicture:
        return decodePictureMessage(bytes);
      default:
        return DecodeError::kWrongType;
    }
  }();
  if (!decoded) return decoded;
  if (!fault(*decoded).empty()) return DecodeError::kBadField;
  const auto header = peek(bytes);
  if (!header) return header.error();
  const Bytes again = encodeValid(*decoded, header->mission, header->time);
  if (!std::equal(again.begin(), again.end(), bytes.begin(), bytes.end())) return DecodeError::kNotCanonical;
  return decoded;
}

}  // namespace shoal::wire
