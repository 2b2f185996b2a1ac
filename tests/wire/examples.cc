// SPDX-License-Identifier: BSD-3-Clause
#include "examples.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <set>

#include "shoal/wire/labels_codec.h"
#include "shoal/wire/map_codec.h"
#include "shoal/wire/matches_codec.h"
#include "shoal/wire/picture_coder.h"
#include "shoal/wire/picture_pieces.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"

namespace shoal::wire {
namespace {

using mapping::BrickPart;
using mapping::CertaintyPart;
using mapping::Piece;
using mapping::PieceKind;
using mapping::TopicPart;
using world::GlobalLabel;
using world::RobotId;
using world::TopicId;

constexpr int32_t kMission = 20210529;

int below(Random& random, int n) { return static_cast<int>(random.below(static_cast<uint64_t>(n))); }

Heartbeat heartbeat() {
  Heartbeat h;
  h.time.us = 61'000'000;
  h.mission = kMission;
  h.epoch = 1;
  h.observation = 60;
  h.num_observations = 250;
  h.phase = Phase::kFlying;
  h.num_topics = 9;
  h.num_cells = 4711;
  h.own_digest = 0x0123456789abcdef;
  h.state_digest = 0xfedcba9876543210;
  h.map_digest = 0x1122334455667788;
  h.map_of_state = 0xfedcba9876543210;
  h.vocabulary = 0xdeadbeefcafef00d;
  h.cell_size_m = 0.8;
  h.host = -77;
  h.pid = 4242;
  h.x_m = 12.5f;
  h.y_m = -34.25f;
  h.z_m = 10.0f;
  h.bytes_sent = 98'765;
  h.budget = 2000;
  h.queue_bytes = 321;
  h.rejected = 2;
  h.conflicts = 0;
  h.ms_per_frame = 17.75f;
  h.class_bytes = {12'000, 0, 40'000, 40'000, 6'165, 600, 0};
  for (int r = 0; r < 12; ++r) h.roster.push_back({RobotId{r}, 0x1000'0000u * static_cast<uint32_t>(r) + 7});
  return h;
}

Piece topic() {
  TopicPart part;
  part.created.us = 3'000'000;
  part.weight = 812;
  part.group_sizes = {200, 64};
  part.words = {{0, 3}, {17, 41}, {18, 1}, {199, 7}, {200, 100}, {263, 2}};
  return {{RobotId{3}, PieceKind::kTopic, {12, 0, 0}}, {1, 60}, 1, 3, part};
}

// One alone, one that is no more, a part of one.
std::vector<Piece> topics() {
  std::vector<Piece> pieces(3, topic());
  pieces[0].key.index[0] = 4;
  pieces[0].version.observation = 55;
  pieces[0].part = 0;
  pieces[0].num_parts = 1;
  std::get<TopicPart>(pieces[0].content) = {{8'000'000}, 5006, {200, 64}, {{3, 20}, {17, 10}, {201, 500}}};
  pieces[1].key.index[0] = 5;
  pieces[1].part = 0;
  pieces[1].num_parts = 1;
  std::get<TopicPart>(pieces[1].content) = {{0}, 0, {200, 64}, {}};
  return pieces;
}

std::vector<Piece> bricks() {
  BrickPart part;
  for (int x = 0; x < 4; ++x) {
    for (int y = 0; y < 3; ++y) {
      if (x == 2 && y == 1) continue;  // a hole
      part.cells.push_back(
          {{-32 + x, 16 + y, x / 3}, TopicId{x < 2 ? 0 : 12}, {(50 + 2 * y) * int64_t{1'000'000}}});
    }
  }
  const BrickPart beside{{{{-14, 17, -1}, TopicId{12}, {52'000'000}}, {{-14, 17, -2}, TopicId{5}, {0}}}};
  BrickPart below = beside;
  std::ranges::sort(below.cells);
  return {{{RobotId{3}, PieceKind::kBrick, {-2, 1, 0}}, {1, 54}, 0, 1, part},
          {{RobotId{3}, PieceKind::kBrick, {-1, 1, -1}}, {1, 49}, 2, 3, below}};
}

std::vector<Piece> certainties() {
  CertaintyPart part;
  for (int y = 0; y < 9; ++y)
    part.cells.push_back(
        {{-32, 16 + y, 0}, static_cast<uint8_t>(7 * y), static_cast<uint8_t>(y == 5 ? 21 : 0)});
  const CertaintyPart above{{{{-32, 20, 16}, 63, 0}, {{-31, 20, 16}, 60, 63}}};
  return {{{RobotId{3}, PieceKind::kCertainty, {-2, 1, 0}}, {1, 54}, 0, 1, part},
          {{RobotId{3}, PieceKind::kCertainty, {-2, 1, 1}}, {1, 60}, 0, 1, above}};
}

std::vector<mapping::Correspondence> matches() {
  return {{RobotId{0}, TopicId{0}, GlobalLabel{0}},
          {RobotId{0}, TopicId{4}, GlobalLabel{4}},
          {RobotId{1}, TopicId{2}, GlobalLabel{0}},
          {RobotId{11}, TopicId{9999}, GlobalLabel{119999}}};
}

std::vector<mapping::LabelSummary> labels() {
  return {{GlobalLabel{0}, "sand", 1234, {RobotId{0}, RobotId{1}}, {0}},
          {GlobalLabel{4}, "", 56, {RobotId{0}}, {4'000'000}},
          {GlobalLabel{119999}, "Seegr\xc3\xa4ser", 7, {RobotId{11}}, {123'456'789}}};
}

// One of each operation.
std::vector<std::pair<std::string, Piece>> pictures() {
  std::vector<uint8_t> rgb(kPictureBytes);  // a disk on a slope
  for (int y = 0; y < kPictureEdge; ++y) {
    for (int x = 0; x < kPictureEdge; ++x) {
      const size_t i = 3 * static_cast<size_t>(y * kPictureEdge + x);
      const bool inside = (x - 12) * (x - 12) + (y - 18) * (y - 18) < 80;
      rgb[i] = static_cast<uint8_t>(inside ? 200 : 40 + 2 * x);
      rgb[i + 1] = static_cast<uint8_t>(inside ? 90 : 120 + 2 * y);
      rgb[i + 2] = static_cast<uint8_t>(inside ? 60 : 130);
    }
  }
  const mapping::ExamplePicture example{TopicId{12}, 1, 54, {-31, 17, 0}, {53'000'000}, rgb};
  const mapping::ExamplePicture gone{TopicId{3}, 0, 60, {-31, 17, 0}, {53'000'000}, {}};
  const auto layers = picturePieces(example, RobotId{3}, 1);
  return {{"picture_0", layers.at(0)},
          {"picture_1", layers.at(1)},
          {"picture_gone", picturePieces(gone, RobotId{3}, 1).at(0)}};
}

std::vector<std::pair<std::string, mapping::Edit>> edits() {
  const mapping::TopicRef a{RobotId{1}, 0, TopicId{4}}, b{RobotId{11}, 2, TopicId{9999}};
  return {{"edit_name", {{"OPERATOR", 1}, {50'000'000}, mapping::NameEdit{a, "Seegr\xc3\xa4ser"}}},
          {"edit_link", {{"OPERATOR", 2}, {51'000'000}, mapping::LinkEdit{a, b, false}}},
          {"edit_unlink", {{"SHIP2", 1}, {52'000'000}, mapping::LinkEdit{a, b, true}}},
          {"edit_exclude", {{"SHIP2", 2}, {53'000'000}, mapping::ExcludeEdit{RobotId{7}}}},
          {"edit_undo", {{"OPERATOR", 3}, {54'000'001}, mapping::UndoEdit{{"SHIP2", 2}}}}};
}

mapping::GlobalMap globalMap() {
  mapping::GlobalMap map;
  for (int x = -1; x <= 1; ++x) {
    for (int y = 0; y < 3; ++y) {
      map.cells.push_back({{x, y, 0},
                           GlobalLabel{x < 0 ? 4 : 110003},
                           RobotId{y % 2},
                           {(10 + y) * int64_t{500'000}},
                           static_cast<float>(21 * (x + 1)) / 63.0f});
    }
  }
  return map;
}

// As comms/repair_talk.h writes it: the sixteen digests of a share, two leaves below one of its nodes, one
// piece wanted.
Bytes talk() {
  Bytes bytes = {1, 2, 3, 4, 4, 3, 0};
  for (uint8_t child = 0; child < 16; ++child)
    bytes.insert(bytes.end(), {child, static_cast<uint8_t>(child * 7)});
  bytes.insert(bytes.end(), {1, 11, 1, 10, 2, 60, 0xa0, 0, 0, 0, 1, 0, 0xaf, 0xff, 0xff, 0xff, 0xff, 3});
  bytes.insert(bytes.end(), {2, 3, 1, 60, 0x12, 0x34, 0x56, 0x78, 0x9a, 0});
  return bytes;
}

}  // namespace

std::vector<Example> goldenExamples() {
  const world::Timestamp time{61'500'000};
  std::vector<Example> examples;
  examples.push_back({"heartbeat", MessageKind::kHeartbeat, encode(heartbeat())});
  Heartbeat landed = heartbeat();
  landed.phase = Phase::kListening;
  landed.learnt = 0x89abcdef;
  examples.push_back({"heartbeat_landed", MessageKind::kHeartbeat, encode(landed)});
  examples.push_back({"topics", MessageKind::kTopics, encode(topic(), kMission, time)});
  examples.push_back({"topics_shared", MessageKind::kTopics, encode(topics(), kMission, time)});
  examples.push_back({"bricks", MessageKind::kBrick, encode(bricks(), kMission, time)});
  examples.push_back({"certainties", MessageKind::kCertainty, encode(certainties(), kMission, time)});
  examples.push_back({"matches", MessageKind::kMatches, encodeMatches(matches(), 77, kMission, time).at(0)});
  examples.push_back({"labels", MessageKind::kLabels, encodeLabels(labels(), 77, kMission, time).at(0)});
  examples.push_back({"map_0", MessageKind::kMap, encodeMap(globalMap(), 77, kMission, time).at(0)});
  examples.push_back({"map_1", MessageKind::kMap, encodeMap(globalMap(), 77, kMission, time).at(1)});
  for (const auto& [name, piece] : pictures()) {
    examples.push_back({name, MessageKind::kPicture, encode(piece, kMission, time)});
  }
  const Piece settings = mapping::pieceOf(RobotId{3}, 1, {0xfedcba9876543210ULL, 0x0123456789abcdefULL, 0.8});
  examples.push_back({"settings", MessageKind::kSettings, encode(settings, kMission, time)});
  examples.push_back({"repair_settings", MessageKind::kRepair, encodeRepair(settings, kMission, time)});
  for (const auto& [name, edit] : edits()) {
    examples.push_back({name, MessageKind::kEdit, encode(mapping::pieceOf(edit), kMission, time)});
  }
  examples.push_back({"request", MessageKind::kRequest, encodeRequest(talk(), kMission, time)});
  examples.push_back({"repair_topic", MessageKind::kRepair, encodeRepair(topic(), kMission, time)});
  examples.push_back({"repair_brick", MessageKind::kRepair, encodeRepair(bricks()[0], kMission, time)});
  examples.push_back({"repair_edit", MessageKind::kRepair,
                      encodeRepair(mapping::pieceOf(edits()[1].second), kMission, time)});
  return examples;
}

Bytes decodeAndEncode(MessageKind kind, std::span<const uint8_t> bytes, DecodeError* error) {
  const auto again = [&](const auto& decoded, auto encode_again) -> Bytes {
    if (decoded.ok()) return encode_again(*decoded);
    if (error != nullptr) *error = decoded.error();
    return {};
  };
  const auto header = peek(bytes);
  const int32_t mission = header ? header->mission : 0;
  const world::Timestamp time = header ? header->time : world::Timestamp{};
  switch (kind) {
    case MessageKind::kHeartbeat:
      return again(decodeHeartbeat(bytes), [](const Heartbeat& h) { return encode(h); });
    case MessageKind::kTopics:
    case MessageKind::kBrick:
    case MessageKind::kCertainty:
    case MessageKind::kEdit:
    case MessageKind::kPicture:
    case MessageKind::kSettings:
      return again(decodePieces(kind, bytes),
                   [&](const std::vector<Piece>& pieces) { return encode(pieces, mission, time); });
    case MessageKind::kMatches:
      return again(decodeMatches(bytes),
                   [&](const MatchesChunk& chunk) { return encode(chunk, mission, time); });
    case MessageKind::kLabels:
      return again(decodeLabels(bytes),
                   [&](const LabelsChunk& chunk) { return encode(chunk, mission, time); });
    case MessageKind::kRequest:
      return again(decodeRequest(bytes),
                   [&](const Bytes& said) { return encodeRequest(said, mission, time); });
    case MessageKind::kRepair:
      return again(decodeRepair(bytes),
                   [&](const Piece& piece) { return encodeRepair(piece, mission, time); });
    case MessageKind::kMap:
      return again(decodeMap(bytes), [&](const MapChunk& chunk) { return encode(chunk, mission, time); });
  }
  return {};
}

Piece planarBrick(int num_labels, int num_times, double slope, uint64_t seed) {
  Random random(seed);
  std::vector<std::array<double, 2>> centres;
  for (int i = 0; i < 2 * num_labels; ++i) centres.push_back({16 * random.uniform(), 16 * random.uniform()});
  const bool along_x = random.below(2) == 0;
  BrickPart part;
  for (int x = 0; x < 16; ++x) {
    for (int y = 0; y < 16; ++y) {
      const auto nearest =
          std::min_element(centres.begin(), centres.end(), [&](const auto& a, const auto& b) {
            return std::hypot(x - a[0], y - a[1]) < std::hypot(x - b[0], y - b[1]);
          });
      int label = static_cast<int>(nearest - centres.begin()) % num_labels;
      if (random.uniform() < 0.03) label = below(random, num_labels);  // speckle
      const int strip = (along_x ? x : y) * num_times / 16;
      part.cells.push_back({{x, y, static_cast<int>(slope * (x + y))},
                            TopicId{3 * label + 1},
                            {(120 + strip) * int64_t{1'000'000}}});
    }
  }
  return {{RobotId{5}, PieceKind::kBrick, {0, 0, 0}}, {0, 140}, 0, 1, part};
}

Piece noiseBrick(const std::array<int32_t, 3>& brick, double density, Random& random) {
  BrickPart part;
  const int64_t time_unit = random.below(2) == 0 ? 1 : 100'000;
  for (int x = 0; x < 16; ++x)
    for (int y = 0; y < 16; ++y)
      for (int z = 0; z < 16; ++z)
        if (random.uniform() < density || (part.cells.empty() && x == 15 && y == 15 && z == 15))
          part.cells.push_back({{brick[0] * 16 + x, brick[1] * 16 + y, brick[2] * 16 + z},
                                TopicId{random.below(20) == 0 ? 9999 : below(random, 7)},
                                {random.below(50) == 0 ? kMaxTimeUs : time_unit * below(random, 1000)}});
  return {{RobotId{below(random, 10000)}, PieceKind::kBrick, brick},
          {below(random, 3), std::numeric_limits<int32_t>::max()},
          0,
          1,
          part};
}

Piece noiseCertainty(const std::array<int32_t, 3>& brick, double density, Random& random) {
  const Piece cells = noiseBrick(brick, density, random);
  CertaintyPart part;
  for (const auto& c : std::get<BrickPart>(cells.content).cells) {
    const auto steps = static_cast<uint8_t>(below(random, 64));
    const int surprise = below(random, 8) == 0 ? 12 + below(random, 52) : 0;
    part.cells.push_back({c.cell, steps, static_cast<uint8_t>(surprise)});
  }
  Piece piece = cells;
  piece.key.kind = PieceKind::kCertainty;
  piece.content = part;
  return piece;
}

Piece topicPiece(int num_words, int vocabulary, int num_groups, int max_count, Random& random) {
  TopicPart part;
  part.created.us = static_cast<int64_t>(random.below(1'000'000'000));
  part.weight = 1 + below(random, 100'000);
  for (int g = 0; g < num_groups; ++g)
    part.group_sizes.push_back(vocabulary / num_groups + (g == 0 ? vocabulary % num_groups : 0));
  std::set<int> words;
  while (static_cast<int>(words.size()) < num_words) words.insert(below(random, vocabulary));
  for (const int word : words) part.words.push_back({word, 1 + max_count / (1 + below(random, num_words))});
  return {{RobotId{below(random, 10000)}, PieceKind::kTopic, {below(random, 10000), 0, 0}},
          {0, below(random, 1000)},
          0,
          1,
          part};
}

Heartbeat noiseHeartbeat(int num_robots, int robot_gap, Random& random) {
  Heartbeat h;
  const auto count = [&] {
    return random.below(3) == 0 ? std::numeric_limits<int32_t>::max() : below(random, 1000);
  };
  h.time.us = random.below(2) == 0 ? kMaxTimeUs : static_cast<int64_t>(random.below(1'000'000'000));
  h.mission = static_cast<int32_t>(random());
  h.epoch = count();
  h.observation = random.below(3) == 0 ? -1 : count();
  h.num_observations = count();
  h.phase = static_cast<Phase>(random.below(5));
  if (hasLanded(h.phase)) h.learnt = static_cast<uint32_t>(random());
  h.num_topics = below(random, 10001);
  h.num_cells = count();
  for (uint64_t* digest : {&h.own_digest, &h.state_digest, &h.map_digest, &h.map_of_state, &h.vocabulary})
    *digest = random.below(4) == 0 ? 0 : random();
  h.cell_size_m = 1e-3 + 100 * random.uniform();
  h.host = static_cast<int32_t>(random());
  h.pid = count();
  h.x_m = static_cast<float>(1e6 * (random.uniform() - 0.5));
  h.y_m = std::numeric_limits<float>::lowest();
  h.z_m = -0.0f;
  h.bytes_sent = random.below(3) == 0 ? std::numeric_limits<int64_t>::max() : count();
  for (int32_t* field : {&h.budget, &h.queue_bytes, &h.rejected, &h.conflicts}) *field = count();
  h.ms_per_frame = static_cast<float>(100 * random.uniform());
  for (int64_t& bytes : h.class_bytes) bytes = count();
  if (random.below(2) == 0) h.battery_percent = static_cast<int32_t>(random.below(102)) - 1;
  if (random.below(2) == 0) h.depth_cm = random.below(2) == 0 ? std::numeric_limits<int32_t>::max() : count();
  int robot = 0;
  for (int i = 0; i < num_robots; ++i) {
    h.roster.push_back({RobotId{robot}, static_cast<uint32_t>(random())});
    robot += 1 + below(random, robot_gap);
  }
  return h;
}

}  // namespace shoal::wire
