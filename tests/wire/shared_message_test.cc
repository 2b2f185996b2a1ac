// SPDX-License-Identifier: BSD-3-Clause
// Several bricks in one message.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "examples.h"
#include "shoal/random.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::wire {
namespace {

using mapping::BrickPart;
using mapping::CertaintyPart;
using mapping::Piece;
using mapping::PieceKind;

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

}  // namespace
}  // namespace shoal::wire
