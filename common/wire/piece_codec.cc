// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/piece_codec.h"

#include <algorithm>
#include <numeric>
#include <shoal/bricks_t.hpp>
#include <shoal/certainties_t.hpp>
#include <shoal/topics_t.hpp>
#include <stdexcept>

#include "shoal/wire/cells_coder.h"
#include "shoal/wire/cut.h"
#include "shoal/wire/edit_message.h"
#include "shoal/wire/message.h"
#include "shoal/wire/payloads.h"
#include "shoal/wire/picture_message.h"
#include "shoal/wire/settings_message.h"

namespace shoal::wire {
namespace {

using mapping::BrickPart;
using mapping::CertaintyPart;
using mapping::Piece;
using mapping::PieceKind;
using mapping::TopicPart;

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
    if (c.surprise > mapping::kMostSurpriseSteps ||
        (c.surprise > 0 && c.surprise < mapping::kLeastSurpriseSteps)) {
      return "surprise steps are 0 or lie in [12, 63]";
    }
  }
  return faultOfCells(certainty.cells, key.index);
}

Bytes encodeTopicMessage(std::span<const Piece* const> pieces, int32_t mission, world::Timestamp time) {
  const Piece& piece = *pieces.front();
  topics_t message{};
  message.utime = time.us;
  message.mission = mission;
  message.part = static_cast<uint8_t>(piece.part);
  message.num_parts = static_cast<uint8_t>(piece.num_parts);
  message.robot = static_cast<int16_t>(number(piece.key.robot));
  message.epoch = piece.version.epoch;
  message.observation = piece.version.observation;
  message.topic = static_cast<int16_t>(piece.key.index[0]);
  message.num_words = static_cast<int32_t>(std::get<TopicPart>(piece.content).words.size());
  return pack(std::move(message), encodeTopics(pieces));
}

template <typename Message>
Message frameOfBricks(std::span<const Piece* const> pieces, int16_t Message::*count, int32_t mission,
                      world::Timestamp time) {
  Message message{};
  message.utime = time.us;
  message.mission = mission;
  message.robot = static_cast<int16_t>(number(pieces.front()->key.robot));
  message.epoch = pieces.front()->version.epoch;
  message.*count = static_cast<int16_t>(pieces.size());
  return message;
}

// Of any size. The pieces are without fault, and can travel together.
Bytes encodeValid(std::span<const Piece* const> pieces, int32_t mission, world::Timestamp time) {
  const Piece& first = *pieces.front();
  if (std::holds_alternative<TopicPart>(first.content)) return encodeTopicMessage(pieces, mission, time);
  if (const auto* edit = std::get_if<mapping::Edit>(&first.content)) return encodeEdit(*edit, mission, time);
  if (std::holds_alternative<mapping::PicturePart>(first.content))
    return encodePictureMessage(first, mission, time);
  if (std::holds_alternative<mapping::SettingsPart>(first.content))
    return encodeSettingsMessage(first, mission, time);
  if (std::holds_alternative<BrickPart>(first.content))
    return pack(frameOfBricks(pieces, &bricks_t::bricks, mission, time), encodeBricks(pieces));
  return pack(frameOfBricks(pieces, &certainties_t::certain_bricks, mission, time),
              encodeCertainties(pieces));
}

Bytes encodeValid(const Piece& piece, int32_t mission, world::Timestamp time) {
  const Piece* const one = &piece;
  return encodeValid(std::span(&one, 1), mission, time);
}

Result<std::vector<Piece>> decodeTopicMessage(std::span<const uint8_t> bytes) {
  const auto message = unpack<topics_t>(bytes);
  if (!message) return message.error();
  if (message->num_words < 0 || message->num_words > static_cast<int32_t>(kMaxWordsPerMessage))
    return DecodeError::kBadField;
  std::vector<Piece> pieces(1);
  Piece& first = pieces.front();
  first.key = {world::RobotId{message->robot}, PieceKind::kTopic, {message->topic, 0, 0}};
  first.version = {message->epoch, message->observation};
  first.part = message->part;
  first.num_parts = message->num_parts;
  if (!decodeTopics(message->payload, message->num_words, pieces)) return DecodeError::kBadPayload;
  return pieces;
}

template <typename Message>
Result<std::vector<Piece>> decodeCells(std::span<const uint8_t> bytes, PieceKind kind,
                                       int16_t Message::*count,
                                       bool (*decode)(std::span<const uint8_t>, std::span<Piece>)) {
  const auto message = unpack<Message>(bytes);
  if (!message) return message.error();
  const int32_t bricks = (*message).*count;
  if (bricks < 1 || bricks > static_cast<int32_t>(kMaxBricksPerMessage)) return DecodeError::kBadField;
  std::vector<Piece> pieces(static_cast<size_t>(bricks));
  for (Piece& piece : pieces) {
    piece.key.robot = world::RobotId{message->robot};
    piece.key.kind = kind;
    piece.version.epoch = message->epoch;
  }
  if (!decode(message->payload, pieces)) return DecodeError::kBadPayload;
  return pieces;
}

Result<std::vector<Piece>> decodeEdits(std::span<const uint8_t> bytes) {
  auto edit = decodeEdit(bytes);
  if (!edit) return edit.error();
  return std::vector{*edit};
}

Result<std::vector<Piece>> decodePictures(std::span<const uint8_t> bytes) {
  auto picture = decodePictureMessage(bytes);
  if (!picture) return picture.error();
  return std::vector{*picture};
}

Result<std::vector<Piece>> decodeSettings(std::span<const uint8_t> bytes) {
  auto settings = decodeSettingsMessage(bytes);
  if (!settings) return settings.error();
  return std::vector{*settings};
}

size_t numCells(const Piece& piece) {
  if (const auto* brick = std::get_if<BrickPart>(&piece.content)) return brick->cells.size();
  if (const auto* certainty = std::get_if<CertaintyPart>(&piece.content)) return certainty->cells.size();
  return 0;
}

// Asked about to say where its cells are.
size_t numPlaces(const Piece& piece) {
  if (const auto* brick = std::get_if<BrickPart>(&piece.content))
    return Occupancy::of(brick->cells).numPlaces();
  if (const auto* certainty = std::get_if<CertaintyPart>(&piece.content))
    return Occupancy::of(certainty->cells).numPlaces();
  return 0;
}

// Why pieces in order of their keys cannot share a message; empty when they can.
std::string faultTogether(std::span<const Piece* const> pieces) {
  const PieceKind kind = pieces.front()->key.kind;
  if (pieces.size() > (kind == PieceKind::kTopic ? kMaxTopicsPerMessage : kMaxBricksPerMessage))
    return "more than 1024 bricks or 256 topics";
  size_t cells = 0, places = 0, words = 0;
  for (size_t i = 0; i < pieces.size(); ++i) {
    const Piece& first = *pieces.front();
    const Piece& piece = *pieces[i];
    if (piece.key.kind != PieceKind::kTopic && piece.key.kind != PieceKind::kBrick &&
        piece.key.kind != PieceKind::kCertainty)
      return "only topics, bricks and certainties travel together";
    if (piece.key.kind != first.key.kind || piece.key.robot != first.key.robot ||
        piece.version.epoch != first.version.epoch)
      return "of several kinds, robots or epochs";
    if (i > 0 && pieces[i - 1]->key == piece.key) return "two of one topic or brick";
    if (const auto* topic = std::get_if<TopicPart>(&piece.content)) {
      words += topic->words.size();
      if (topic->group_sizes != std::get<TopicPart>(first.content).group_sizes)
        return "of several vocabularies";
    }
    cells += numCells(piece);
    places += numPlaces(piece);
  }
  if (cells > kMaxCellsPerMessage) return "more than 32768 cells together";
  if (places > kMaxPlacesPerMessage) return "more than 131072 places for cells together";
  if (words > kMaxWordsPerMessage) return "more than 65536 words together";
  return {};
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
    case 4:
      return MessageKind::kPicture;
    default:
      return MessageKind::kSettings;
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
  if (const auto* settings = std::get_if<mapping::SettingsPart>(&piece.content))
    return faultOf(*settings, piece);
  return faultOf(std::get<CertaintyPart>(piece.content), piece.key);
}

Bytes encode(const Piece& piece, int32_t mission, world::Timestamp time) {
  return encode(std::span(&piece, 1), mission, time);
}

Bytes encode(std::span<const Piece> pieces, int32_t mission, world::Timestamp time) {
  if (!isTime(time))
    throw std::invalid_argument("time of sending out of range: " + std::to_string(time.us) + " us");
  if (pieces.empty()) throw std::invalid_argument("a message holds at least one piece");
  std::vector<const Piece*> sorted;
  for (const Piece& piece : pieces) {
    if (const std::string why = fault(piece); !why.empty()) throw std::invalid_argument("piece: " + why);
    sorted.push_back(&piece);
  }
  if (pieces.size() > 1) {
    std::ranges::sort(sorted, {}, [](const Piece* piece) { return piece->key; });
    if (const std::string why = faultTogether(sorted); !why.empty())
      throw std::invalid_argument("pieces: " + why);
  }
  const auto* topic = std::get_if<TopicPart>(&pieces.front().content);
  if (topic != nullptr && topic->words.size() > kMaxWordsPerMessage) {
    throw std::invalid_argument("piece: more than 65536 words in a part: cut it to fit first");
  }
  return checkedSize(encodeValid(sorted, mission, time), "piece");
}

std::optional<Bytes> encodeTogether(std::span<const Piece* const> pieces, int32_t mission) {
  std::vector<const Piece*> sorted(pieces.begin(), pieces.end());
  std::ranges::sort(sorted, {}, [](const Piece* piece) { return piece->key; });
  if (sorted.empty() || !faultTogether(sorted).empty()) return std::nullopt;
  return encodeValid(sorted, mission, {});
}

std::vector<Piece> cutToFit(const Piece& whole, size_t max_payload) {
  if (const std::string why = fault(whole); !why.empty()) throw std::invalid_argument("piece: " + why);
  if (std::holds_alternative<mapping::Edit>(whole.content)) return {whole};         // always small
  if (std::holds_alternative<mapping::PicturePart>(whole.content)) return {whole};  // cut into layers already
  if (std::holds_alternative<mapping::SettingsPart>(whole.content)) return {whole};
  if (whole.num_parts != 1) throw std::invalid_argument("piece: it is a part already");
  const auto cut = [&](const auto& part, size_t count, size_t max_run) {
    const auto make = [&](size_t begin, size_t end) {
      Piece piece{whole.key, whole.version, 0, 1, {}};
      piece.content = part(begin, end);
      return piece;
    };
    const auto runs = cutRuns(count, max_run, [&](size_t begin, size_t end) {
      Piece piece = make(begin, end);
      if (end - begin == count) return encodeValid(piece, 0, {}).size() <= max_payload;
      piece.num_parts =
          kMaxParts;  // numbers that are not known yet: a stream may end a byte later with others
      piece.part = kMaxParts - 1;
      return encodeValid(piece, 0, {}).size() + 1 <= max_payload;
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
               kMaxWordsPerMessage);
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

std::vector<EncodedPart> encodeToFit(const Piece& whole, size_t max_payload, int32_t mission) {
  const auto* topic = std::get_if<TopicPart>(&whole.content);
  const bool may_fit =
      whole.num_parts == 1 && (topic == nullptr || topic->words.size() <= kMaxWordsPerMessage);
  if (may_fit && fault(whole).empty()) {
    Bytes message = encodeValid(whole, mission, {});
    if (message.size() <= std::min(max_payload, kMaxMessageBytes)) return {{whole, std::move(message)}};
  }
  std::vector<EncodedPart> parts;
  for (Piece& part : cutToFit(whole, max_payload)) {
    Bytes message = encode(part, mission, {});
    parts.push_back({std::move(part), std::move(message)});
  }
  return parts;
}

Result<std::vector<Piece>> decodePieces(MessageKind kind, std::span<const uint8_t> bytes) {
  auto decoded = [&]() -> Result<std::vector<Piece>> {
    switch (kind) {
      case MessageKind::kTopics:
        return decodeTopicMessage(bytes);
      case MessageKind::kBrick:
        return decodeCells<bricks_t>(bytes, PieceKind::kBrick, &bricks_t::bricks, decodeBricks);
      case MessageKind::kCertainty:
        return decodeCells<certainties_t>(bytes, PieceKind::kCertainty, &certainties_t::certain_bricks,
                                          decodeCertainties);
      case MessageKind::kEdit:
        return decodeEdits(bytes);
      case MessageKind::kPicture:
        return decodePictures(bytes);
      case MessageKind::kSettings:
        return decodeSettings(bytes);
      default:
        return DecodeError::kWrongType;
    }
  }();
  if (!decoded) return decoded;
  std::vector<const Piece*> pieces;
  for (const Piece& piece : *decoded) {
    if (!fault(piece).empty()) return DecodeError::kBadField;
    pieces.push_back(&piece);
  }
  const auto header = peek(bytes);
  if (!header) return header.error();
  const Bytes again = encodeValid(pieces, header->mission, header->time);
  if (!std::equal(again.begin(), again.end(), bytes.begin(), bytes.end())) return DecodeError::kNotCanonical;
  return decoded;
}

}  // namespace shoal::wire
