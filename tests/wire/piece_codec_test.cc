// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/piece_codec.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "examples.h"

namespace shoal::wire {
namespace {

using mapping::BrickPart;
using mapping::CertaintyPart;
using mapping::Piece;
using mapping::TopicPart;

constexpr int32_t kEdgeOfTheWorld = 1 << 27;  // bricks whose cells are the extremes of 32 bits
const std::vector<std::array<int32_t, 3>> kBricks = {
    {0, 0, 0},
    {-1, 3, -7},
    {kEdgeOfTheWorld - 1, -kEdgeOfTheWorld, 0},
    {-kEdgeOfTheWorld, kEdgeOfTheWorld - 1, kEdgeOfTheWorld - 1}};

void expectRoundTrip(const Piece& piece) {
  const int32_t mission = -5;
  const world::Timestamp time{123'456'789};
  const Bytes bytes = encode(piece, mission, time);
  const auto decoded = decodePieces(kindOf(piece), bytes);
  ASSERT_TRUE(decoded.ok()) << name(decoded.error());
  ASSERT_EQ(decoded->size(), 1u);
  EXPECT_TRUE(decoded->front() == piece);
  const auto header = peek(bytes);
  ASSERT_TRUE(header.ok());
  EXPECT_EQ(header->kind, kindOf(piece));
  EXPECT_EQ(header->mission, mission);
  EXPECT_EQ(header->time, time);
}

// Every part round-trips, is within the limit, and together they are the whole.
void expectPartsMakeTheWhole(const Piece& whole, size_t max_payload) {
  const auto parts = cutToFit(whole, max_payload);
  ASSERT_FALSE(parts.empty());
  Piece joined = parts[0];
  joined.num_parts = 1;
  for (size_t i = 0; i < parts.size(); ++i) {
    EXPECT_EQ(parts[i].part, static_cast<int32_t>(i));
    EXPECT_EQ(parts[i].num_parts, static_cast<int32_t>(parts.size()));
    EXPECT_LE(encode(parts[i], 1, {}).size(), max_payload);
    expectRoundTrip(parts[i]);
    if (i == 0) continue;
    if (auto* topic = std::get_if<TopicPart>(&joined.content)) {
      const auto& words = std::get<TopicPart>(parts[i].content).words;
      topic->words.insert(topic->words.end(), words.begin(), words.end());
    } else if (auto* brick = std::get_if<BrickPart>(&joined.content)) {
      const auto& cells = std::get<BrickPart>(parts[i].content).cells;
      brick->cells.insert(brick->cells.end(), cells.begin(), cells.end());
    } else {
      auto& all = std::get<CertaintyPart>(joined.content).cells;
      const auto& cells = std::get<CertaintyPart>(parts[i].content).cells;
      all.insert(all.end(), cells.begin(), cells.end());
    }
  }
  if (auto* topic = std::get_if<TopicPart>(&joined.content))
    std::sort(topic->words.begin(), topic->words.end());
  EXPECT_TRUE(joined == whole);
}

TEST(PieceCodecTest, KeepsBricksOfAnyDensityEverywhere) {
  Random random(3);
  for (const auto& index : kBricks) {
    for (const double density : {0.0, 0.01, 0.1, 0.5, 1.0}) {
      expectPartsMakeTheWhole(noiseBrick(index, density, random), kMaxMessageBytes);
      expectPartsMakeTheWhole(noiseCertainty(index, density, random), kMaxMessageBytes);
    }
  }
}

TEST(PieceCodecTest, KeepsPlanarBricksInOneMessage) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    for (const double slope : {0.0, 0.1, 0.4}) expectRoundTrip(planarBrick(5, 10, slope, seed));
  }
}

TEST(PieceCodecTest, KeepsTopics) {
  Random random(4);
  for (int trial = 0; trial < 60; ++trial) {
    const int vocabulary = 64 << (trial % 8);
    const int num_words =
        static_cast<int>(random.below(static_cast<uint64_t>(std::min(vocabulary, 1500)) + 1));
    expectPartsMakeTheWhole(topicPiece(num_words, vocabulary, 1 + trial % 64, 1 + trial, random),
                            kMaxMessageBytes);
  }
}

TEST(PieceCodecTest, KeepsATopicWithoutWords) {
  Random random(5);
  expectRoundTrip(topicPiece(0, 1, 1, 1, random));
  expectPartsMakeTheWhole(topicPiece(0, 1000, 3, 1, random), 200);
}

// Weight 0 says that the topic is no more.
TEST(PieceCodecTest, KeepsARetiredTopic) {
  Random random(5);
  Piece piece = topicPiece(0, 1000, 3, 1, random);
  std::get<TopicPart>(piece.content).weight = 0;
  expectRoundTrip(piece);
}

TEST(PieceCodecTest, KeepsExtremes) {
  Random random(6);
  Piece piece = topicPiece(0, 64, 64, 1, random);
  auto& topic = std::get<TopicPart>(piece.content);
  piece.version = {std::numeric_limits<int32_t>::max(), std::numeric_limits<int32_t>::max()};
  piece.key.robot = world::RobotId{9999};
  piece.key.index = {9999, 0, 0};
  piece.part = 254;
  piece.num_parts = 255;
  topic.created.us = kMaxTimeUs;
  topic.weight = kMaxTimeUs;
  topic.group_sizes[63] = kMaxVocabulary - 63;
  topic.words = {{0, std::numeric_limits<int32_t>::max()},
                 {kMaxVocabulary - 1, std::numeric_limits<int32_t>::max()}};
  expectRoundTrip(piece);
}

TEST(PieceCodecTest, WritesEqualPiecesAsEqualBytes) {
  EXPECT_EQ(encode(planarBrick(5, 10, 0.1, 1), 7, {8}), encode(planarBrick(5, 10, 0.1, 1), 7, {8}));
}

// Bounds with a third to spare over what was measured (docs/benchmarks.md).
TEST(PieceCodecTest, SpendsLittleOnGroundSeenFromAbove) {
  double flat = 0;
  double sloping = 0;
  for (uint64_t seed = 0; seed < 50; ++seed) {
    flat += static_cast<double>(encode(planarBrick(5, 10, 0.0, seed), 1, {}).size()) / 256 / 50;
    sloping += static_cast<double>(encode(planarBrick(5, 10, 0.1, seed), 1, {}).size()) / 256 / 50;
  }
  EXPECT_LT(flat, 0.55);     // bytes per cell, all of the message counted
  EXPECT_LT(sloping, 0.68);  // likewise
}

TEST(CutToFitTest, LeavesWhatFitsAlone) {
  const Piece piece = planarBrick(5, 10, 0.1, 2);
  const auto parts = cutToFit(piece, kMaxMessageBytes);
  ASSERT_EQ(parts.size(), 1u);
  EXPECT_TRUE(parts[0] == piece);
}

TEST(CutToFitTest, FillsMessagesOfAnySize) {
  Random random(7);
  for (const size_t max_payload : {160u, 250u, 600u, 1391u}) {
    expectPartsMakeTheWhole(noiseBrick({1, -1, 0}, 0.3, random), max_payload);
    expectPartsMakeTheWhole(noiseCertainty({1, -1, 0}, 0.3, random), max_payload);
    expectPartsMakeTheWhole(topicPiece(900, 5000, 3, 100, random), max_payload);
  }
}

TEST(CutToFitTest, SendsTheHeaviestWordsFirstAndTiesByWord) {
  Random random(8);
  const Piece whole = topicPiece(2000, 5000, 2, 90, random);
  const auto parts = cutToFit(whole, 400);
  ASSERT_GT(parts.size(), 2u);
  const auto rank = [](const world::WordCount& w) { return std::pair(-w.count, w.word); };
  for (size_t i = 1; i < parts.size(); ++i) {
    const auto& before = std::get<TopicPart>(parts[i - 1].content).words;
    const auto& after = std::get<TopicPart>(parts[i].content).words;
    auto last = rank(before[0]);
    for (const auto& w : before) last = std::max(last, rank(w));
    for (const auto& w : after) EXPECT_LT(last, rank(w));
  }
}

// The worst that a vocabulary of 65536 words can hold still travels.
TEST(CutToFitTest, NeedsFewerThan255PartsForAnyTopic) {
  Random random(9);
  Piece whole = topicPiece(0, 65536, 2, 1, random);
  auto& words = std::get<TopicPart>(whole.content).words;
  for (int32_t w = 0; w < 65536; ++w)
    words.push_back({w, 1 + static_cast<int32_t>(random.below(0x7fffffff))});
  const auto parts = cutToFit(whole, maxPayload(24));
  EXPECT_LE(parts.size(), 255u);
  size_t total = 0;
  for (const auto& part : parts) total += std::get<TopicPart>(part.content).words.size();
  EXPECT_EQ(total, words.size());
}

TEST(CutToFitTest, RefusesWhatCannotBeCut) {
  Random random(10);
  const Piece topic = topicPiece(3000, 5000, 2, 90, random);
  EXPECT_THROW(cutToFit(topic, 60), std::invalid_argument);                               // not one word
  EXPECT_THROW(cutToFit(planarBrick(1, 1, 0, 1), 20), std::invalid_argument);             // not one cell
  EXPECT_THROW(cutToFit(noiseBrick({0, 0, 0}, 1.0, random), 80), std::invalid_argument);  // above 255 parts
  Piece part = topic;
  part.num_parts = 2;
  EXPECT_THROW(cutToFit(part, 1000), std::invalid_argument);
}

TEST(PieceCodecTest, RefusesToEncodeWhatIsTooLarge) {
  Random random(11);
  EXPECT_THROW(encode(noiseBrick({0, 0, 0}, 1.0, random), 1, {}), std::invalid_argument);
}

// One fault each; every one is named by fault() and stopped by encode().
TEST(PieceCodecTest, RefusesFaultyPieces) {
  Random random(12);
  const Piece topic = topicPiece(10, 100, 2, 9, random);
  const Piece brick = planarBrick(2, 2, 0, 1);
  const auto broken = [](Piece piece, auto change) {
    change(piece);
    EXPECT_NE(fault(piece), "");
    EXPECT_THROW(encode(piece, 1, {}), std::invalid_argument);
  };
  EXPECT_EQ(fault(topic), "");
  EXPECT_EQ(fault(brick), "");
  broken(topic, [](Piece& p) { p.key.robot = world::RobotId{-1}; });
  broken(topic, [](Piece& p) { p.key.robot = world::RobotId{10000}; });
  broken(topic, [](Piece& p) { p.key.kind = mapping::PieceKind::kBrick; });
  broken(topic, [](Piece& p) { p.key.index = {10000, 0, 0}; });
  broken(topic, [](Piece& p) { p.key.index = {1, 0, 1}; });
  broken(topic, [](Piece& p) { p.version.epoch = -1; });
  broken(topic, [](Piece& p) { p.part = 1; });
  broken(topic, [](Piece& p) { p.num_parts = 256; });
  broken(topic, [](Piece& p) { std::get<TopicPart>(p.content).weight = 0; });  // yet it has words
  broken(topic, [](Piece& p) { std::get<TopicPart>(p.content).weight = -1; });
  broken(topic, [](Piece& p) { std::get<TopicPart>(p.content).group_sizes.clear(); });
  broken(topic, [](Piece& p) { std::get<TopicPart>(p.content).group_sizes[0] = 0; });
  broken(topic, [](Piece& p) { std::get<TopicPart>(p.content).group_sizes[0] = 1 << 20; });
  broken(topic, [](Piece& p) { std::get<TopicPart>(p.content).words.back().word = 100; });
  broken(topic, [](Piece& p) { std::get<TopicPart>(p.content).words[0].count = 0; });
  broken(topic, [](Piece& p) {
    std::swap(std::get<TopicPart>(p.content).words[0], std::get<TopicPart>(p.content).words[1]);
  });
  broken(brick, [](Piece& p) { p.key.kind = mapping::PieceKind::kCertainty; });
  broken(brick, [](Piece& p) { p.key.index = {1, 0, 0}; });
  broken(brick, [](Piece& p) { std::get<BrickPart>(p.content).cells.clear(); });
  broken(brick, [](Piece& p) { std::get<BrickPart>(p.content).cells[0].topic = world::TopicId{10000}; });
  broken(brick, [](Piece& p) { std::get<BrickPart>(p.content).cells[0].seen.us = -1; });
  broken(brick,
         [](Piece& p) { std::get<BrickPart>(p.content).cells[1] = std::get<BrickPart>(p.content).cells[0]; });
  Piece certainty = noiseCertainty({0, 0, 0}, 0.01, random);
  EXPECT_EQ(fault(certainty), "");
  broken(certainty, [](Piece& p) { std::get<CertaintyPart>(p.content).cells[0].steps = 64; });
  broken(certainty, [](Piece& p) { std::get<CertaintyPart>(p.content).cells[0].surprise = 64; });
  broken(certainty, [](Piece& p) { std::get<CertaintyPart>(p.content).cells[0].surprise = 11; });
  EXPECT_THROW(encode(topic, 1, {-1}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::wire
