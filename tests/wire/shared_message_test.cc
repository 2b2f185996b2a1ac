// SPDX-License-Identifier: BSD-3-Clause
// Several bricks, or topics, in one message.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "examples.h"
#include "shoal/random.h"
#include "shoal/wire/checksum.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"

namespace shoal::wire {
namespace {

using mapping::BrickPart;
using mapping::CertaintyPart;
using mapping::Piece;
using mapping::PieceKind;
using mapping::TopicPart;

// Bricks of one robot at random places, sorted, some of them parts.
std::vector<Piece> someBricks(int count, double density, Random& random) {
  std::vector<Piece> pieces;
  const auto coordinate = [&] { return static_cast<int32_t>(random.below(7)) - 3; };
  while (std::ssize(pieces) < count) {
    Piece piece = noiseBrick({coordinate(), coordinate(), coordinate()}, density, random);
    piece.key.robot = world::RobotId{4};
    piece.version = {2, static_cast<int32_t>(random.below(300))};
    if (random.below(4) == 0) {
      piece.num_parts = 2 + static_cast<int32_t>(random.below(254));
      piece.part = static_cast<int32_t>(random.below(static_cast<uint64_t>(piece.num_parts)));
    }
    const auto same = [&](const Piece& other) { return other.key == piece.key; };
    if (std::ranges::none_of(pieces, same)) pieces.push_back(piece);
  }
  std::ranges::sort(pieces, {}, &Piece::key);
  return pieces;
}

std::vector<Piece> certaintiesOf(std::vector<Piece> pieces, Random& random) {
  for (Piece& piece : pieces) {
    CertaintyPart part;
    for (const auto& c : std::get<BrickPart>(piece.content).cells) {
      const auto steps = static_cast<uint8_t>(random.below(mapping::kCertaintySteps + 1));
      const uint64_t surprise = random.below(20) == 0 ? 12 + random.below(52) : 0;
      part.cells.push_back({c.cell, steps, static_cast<uint8_t>(surprise)});
    }
    piece.key.kind = PieceKind::kCertainty;
    piece.content = part;
  }
  return pieces;
}

TEST(SharedMessageTest, KeepsEveryBrick) {
  Random random(1);
  for (int trial = 0; trial < 60; ++trial) {
    const auto bricks = someBricks(1 + trial % 12, trial % 3 == 0 ? 0.0 : 0.004, random);
    for (const auto& pieces : {bricks, certaintiesOf(bricks, random)}) {
      const Bytes bytes = encode(pieces, 9, {77});
      const auto decoded = decodePieces(kindOf(pieces.front()), bytes);
      ASSERT_TRUE(decoded.ok()) << name(decoded.error());
      EXPECT_TRUE(*decoded == pieces);
      auto shuffled = pieces;
      std::ranges::reverse(shuffled);
      EXPECT_EQ(encode(shuffled, 9, {77}), bytes);
    }
  }
}

TEST(SharedMessageTest, IsSmallerThanItsBricksAlone) {
  std::vector<Piece> pieces;
  size_t alone = 0;
  for (int x = 0; x < 4; ++x) {
    Piece piece = planarBrick(5, 4, 0, static_cast<uint64_t>(x));
    piece.key.index[0] = x;
    for (auto& c : std::get<BrickPart>(piece.content).cells) c.cell.x += 16 * x;
    alone += encode(piece, 1, {}).size();
    pieces.push_back(piece);
  }
  EXPECT_LT(encode(pieces, 1, {}).size(), alone * 8 / 10);
}

TEST(SharedMessageTest, RefusesWhatCannotShare) {
  Random random(2);
  const auto bricks = someBricks(2, 0, random);
  const auto refused = [&](auto change) {
    auto pieces = bricks;
    change(pieces[1]);
    EXPECT_THROW(encode(pieces, 1, {}), std::invalid_argument);
  };
  refused([&](Piece& p) { p.key.robot = world::RobotId{5}; });
  refused([&](Piece& p) { p.version.epoch = 3; });
  refused([&](Piece& p) { p = bricks[0]; });
  refused([&](Piece& p) { p = certaintiesOf(bricks, random)[1]; });
  refused([&](Piece& p) { p = topicPiece(3, 100, 1, 9, random); });
  EXPECT_THROW(encode(std::vector<Piece>{}, 1, {}), std::invalid_argument);
  const auto topics = std::vector{topicPiece(3, 100, 1, 9, random), topicPiece(3, 100, 1, 9, random)};
  EXPECT_THROW(encode(topics, 1, {}), std::invalid_argument);
}

TEST(EncodeTogetherTest, SaysWhatThePiecesSayOrNothing) {
  Random random(3);
  const auto pieces = someBricks(5, 0.002, random);
  std::vector<const Piece*> pointers;
  for (const Piece& piece : pieces) pointers.push_back(&piece);
  std::ranges::reverse(pointers);
  EXPECT_EQ(encodeTogether(pointers, 6), encode(pieces, 6, {}));
  pointers.push_back(&pieces[0]);  // twice
  EXPECT_FALSE(encodeTogether(pointers, 6));
  EXPECT_FALSE(encodeTogether({}, 6));
  const Piece topic = topicPiece(3, 100, 1, 9, random);
  const std::vector<const Piece*> topics = {&topic, &topic};
  EXPECT_FALSE(encodeTogether(topics, 6));
}

// Topics of one robot and vocabulary, ascending, some of them parts, some that are no more.
std::vector<Piece> someTopics(int count, int words, Random& random) {
  std::vector<Piece> pieces;
  for (int i = 0, id = -1; i < count; ++i) {
    Piece piece = topicPiece(1 + words * (i % 4), 4 * words + 100, 5, 1 + 1000 * (i % 3), random);
    id += 1 + static_cast<int32_t>(random.below(30));
    piece.key = {world::RobotId{4}, PieceKind::kTopic, {id, 0, 0}};
    piece.version = {2, static_cast<int32_t>(random.below(i % 2 == 0 ? 300 : 0x80000000))};
    auto& topic = std::get<TopicPart>(piece.content);
    topic.created.us = static_cast<int64_t>(random.below(1000)) * 500'000;
    if (random.below(5) == 0) topic = {{0}, 0, topic.group_sizes, {}};
    if (random.below(4) == 0) {
      piece.num_parts = 2 + static_cast<int32_t>(random.below(254));
      piece.part = static_cast<int32_t>(random.below(static_cast<uint64_t>(piece.num_parts)));
    }
    pieces.push_back(piece);
  }
  return pieces;
}

TEST(SharedTopicsTest, KeepsEveryTopic) {
  Random random(4);
  for (int trial = 0; trial < 60; ++trial) {
    const auto pieces = someTopics(1 + trial % 12, trial % 3 == 0 ? 0 : 20, random);
    const Bytes bytes = encode(pieces, 9, {77});
    const auto decoded = decodePieces(MessageKind::kTopics, bytes);
    ASSERT_TRUE(decoded.ok()) << name(decoded.error());
    EXPECT_TRUE(*decoded == pieces);
    auto shuffled = pieces;
    std::ranges::reverse(shuffled);
    EXPECT_EQ(encode(shuffled, 9, {77}), bytes);
  }
}

// Fields, vocabulary and what was learnt of gaps and counts are said once. 45 bytes of fixed fields and 14 of
// group sizes and times for each of eight topics are most of it.
TEST(SharedTopicsTest, TakesLessThanAloneByWhatIsSaidOnce) {
  Random random(5);
  std::vector<Piece> pieces;
  size_t alone = 0;
  for (int i = 0; i < 8; ++i) {
    pieces.push_back(topicPiece(30, 1200, 7, 9, random));
    pieces.back().key = {world::RobotId{1}, PieceKind::kTopic, {3 * i, 0, 0}};
    pieces.back().version.epoch = 0;
    alone += encode(pieces.back(), 1, {}).size();
  }
  EXPECT_LT(encode(pieces, 1, {}).size() + 7 * (45 + 14), alone);
}

TEST(SharedTopicsTest, RefusesWhatCannotShare) {
  Random random(6);
  const auto topics = someTopics(2, 10, random);
  const auto refused = [&](auto change) {
    auto pieces = topics;
    change(pieces[1]);
    EXPECT_THROW(encode(pieces, 1, {}), std::invalid_argument);
  };
  EXPECT_NO_THROW(encode(topics, 1, {}));
  refused([&](Piece& p) { p.key.robot = world::RobotId{5}; });
  refused([&](Piece& p) { p.version.epoch = 3; });
  refused([&](Piece& p) { p.key = topics[0].key; });
  refused([&](Piece& p) { std::get<TopicPart>(p.content).group_sizes.push_back(1); });
  refused([&](Piece& p) { p = someBricks(1, 0, random)[0]; });
}

TEST(SharedTopicsTest, HasACapOnTopicsAndOnWords) {
  std::vector<Piece> pieces;
  for (int i = 0; i < 257; ++i)
    pieces.push_back(
        {{world::RobotId{0}, PieceKind::kTopic, {i, 0, 0}}, {0, 1}, 0, 1, TopicPart{{0}, 1, {9}, {}}});
  EXPECT_THROW(encode(pieces, 1, {}), std::invalid_argument);
  pieces.pop_back();
  EXPECT_TRUE(decodePieces(MessageKind::kTopics, encode(pieces, 1, {})).ok());

  TopicPart full{{0}, 1, {40000}, {}};
  for (int32_t word = 0; word < 32769; ++word) full.words.push_back({word, 1});
  pieces = {{{world::RobotId{0}, PieceKind::kTopic, {0, 0, 0}}, {0, 1}, 0, 1, full},
            {{world::RobotId{0}, PieceKind::kTopic, {1, 0, 0}}, {0, 1}, 0, 1, full}};
  EXPECT_THROW(encode(pieces, 1, {}), std::invalid_argument);
  for (Piece& piece : pieces) std::get<TopicPart>(piece.content).words.pop_back();
  const auto decoded = decodePieces(MessageKind::kTopics, encode(pieces, 1, {}));  // 65536 words alike
  ASSERT_TRUE(decoded.ok());
  EXPECT_TRUE(*decoded == pieces);
}

// A repair holds one topic.
TEST(SharedTopicsTest, IsNoRepair) {
  Random random(7);
  const auto topics = someTopics(2, 10, random);
  Bytes whole = encode(topics, 1, {});
  Bytes repair = encodeRepair(topics[0], 1, {});
  const Bytes alone = encode(topics[0], 1, {});
  ASSERT_TRUE(decodeRepair(repair).ok());
  const size_t fixed = fixedBytesOf(MessageKind::kRepair);
  repair.resize(repair.size() - (alone.size() - fixedBytesOf(MessageKind::kTopics)));
  repair.insert(repair.end(), whole.begin() + static_cast<ptrdiff_t>(fixedBytesOf(MessageKind::kTopics)),
                whole.end());
  const size_t n = repair.size() - fixed;
  for (size_t i = 0; i < 4; ++i) repair[fixed - 1 - i] = static_cast<uint8_t>(n >> 8 * i);
  writeChecksum(repair, fixed);
  EXPECT_FALSE(decodeRepair(repair).ok());
}

// No message makes a receiver hold more cells than the cap, whatever it says.
TEST(SharedMessageTest, HasACapOnCells) {
  std::vector<Piece> pieces;
  for (int x = 0; x < 9; ++x) {
    BrickPart full;
    for (int i = 0; i < 4096; ++i)
      full.cells.push_back({{16 * x + i / 256, i / 16 % 16, i % 16}, world::TopicId{1}, {0}});
    pieces.push_back({{world::RobotId{0}, PieceKind::kBrick, {x, 0, 0}}, {0, 1}, 0, 1, full});
  }
  EXPECT_THROW(encode(pieces, 1, {}), std::invalid_argument);
  pieces.pop_back();
  const Bytes bytes = encode(pieces, 1, {});  // 32768 cells alike
  EXPECT_LT(bytes.size(), 200u);
  const auto decoded = decodePieces(MessageKind::kBrick, bytes);
  ASSERT_TRUE(decoded.ok());
  EXPECT_TRUE(*decoded == pieces);
}

// Nor look for cells in more places: a few cells each on the floor and the ceiling of a brick are 4096
// places.
TEST(SharedMessageTest, HasACapOnPlaces) {
  std::vector<Piece> pieces;
  for (int x = 0; x < 33; ++x) {
    BrickPart tall;
    for (const int z : {0, 15}) tall.cells.push_back({{16 * x, 0, z}, world::TopicId{1}, {0}});
    pieces.push_back({{world::RobotId{0}, PieceKind::kBrick, {x, 0, 0}}, {0, 1}, 0, 1, tall});
  }
  Random random(8);
  for (auto some : {pieces, certaintiesOf(pieces, random)}) {
    EXPECT_THROW(encode(some, 1, {}), std::invalid_argument);
    std::vector<const Piece*> pointers;
    for (const Piece& piece : some) pointers.push_back(&piece);
    EXPECT_FALSE(encodeTogether(pointers, 1));
    some.pop_back();
    const auto decoded = decodePieces(kindOf(some.front()), encode(some, 1, {}));  // 131072 places
    ASSERT_TRUE(decoded.ok());
    EXPECT_TRUE(*decoded == some);
  }
}

}  // namespace
}  // namespace shoal::wire
