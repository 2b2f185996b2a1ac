// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/fused_map.h"

#include <map>

#include <gtest/gtest.h>

#include "plain_fusion.h"
#include "shoal/mapping/fusion.h"
#include "shoal/mapping/surprises.h"
#include "shoal/mapping/told_surprises.h"
#include "shoal/random.h"

namespace shoal::mapping {
namespace {

using world::RobotId;
using world::TopicId;

// Everything a map shows, and its digest, is that of the plain definition.
void expectEqual(const GlobalMap& map, const GlobalMap& plain) {
  ASSERT_EQ(map.cells, plain.cells);
  ASSERT_EQ(map.correspondences, plain.correspondences);
  ASSERT_EQ(map.labels, plain.labels);
  ASSERT_EQ(map.state_digest, plain.state_digest);
  ASSERT_EQ(map.digest(), plain.digest());
}

void expectEqual(const FusedMap& fused, const GlobalMap& plain) {
  expectEqual(fused.map(), plain);
  ASSERT_EQ(fused.correspondences(), plain.correspondences);
  ASSERT_EQ(fused.labels(), plain.labels);
  ASSERT_EQ(fused.stateDigest(), plain.state_digest);
  ASSERT_EQ(fused.digest(), plain.digest());
  ASSERT_EQ(fused.numCells(), std::ssize(plain.cells));
  std::map<BrickColumn, uint64_t> hashes;
  for (const GlobalCell& c : plain.cells)
    hashes[{c.cell.x >> 4, c.cell.y >> 4}] +=
        cellHash(c.cell, c.robot, c.seen, c.certainty) * labelFactor(c.label);
  ASSERT_EQ(fused.columnHashes(), hashes);
  std::set<BrickColumn> some{{7, 7}};  // where nobody was
  for (const auto& [column, hash] : hashes)
    if (hash % 2 == 0) some.insert(column);
  std::vector<GlobalCell> expected;
  for (const GlobalCell& c : plain.cells)
    if (some.contains({c.cell.x >> 4, c.cell.y >> 4})) expected.push_back(c);
  ASSERT_EQ(fused.cellsIn(some), expected);
}

// A mission of five robots in a place of 3 x 3 x 2 bricks, where whatever may happen happens: bricks grow,
// shrink and come in parts, of which some repeat a cell; topics come, change and go; robots begin anew;
// operators name, exclude and undo.
class Mission {
 public:
  explicit Mission(uint64_t seed) : random_(seed) {}

  Piece next() {
    const RobotId robot{below(5) * 3};
    if (below(100) == 0) ++epoch_[robot];
    const world::Version version{epoch_[robot], ++observation_ - below(4)};
    const int32_t num_parts = 1 + below(2);
    Piece piece{{robot, PieceKind::kTopic, {}}, version, below(num_parts), num_parts, {}};
    switch (below(8)) {
      case 0:
      case 1: {
        piece.key.index = {below(6), 0, 0};
        TopicPart part{{below(50)}, below(9) == 0 ? 0 : 40, {60}, {}};
        const int32_t first = below(40);
        for (int32_t w = 0; part.weight > 0 && w < 20; w += 1 + below(3))
          part.words.push_back({first + w, 1 + below(9)});
        piece.content = part;
        break;
      }
      case 2:
      case 3: {
        piece.key = {robot, PieceKind::kCertainty, brick()};
        CertaintyPart part;
        for (const world::CellIndex& cell : cells(piece.key.index))
          part.cells.push_back({cell, static_cast<uint8_t>(below(kCertaintySteps + 1)),
                                static_cast<uint8_t>(below(3) == 0 ? kLeastSurpriseSteps + below(50) : 0)});
        piece.content = part;
        break;
      }
      case 4:
        if (below(5) == 0) return edit();
        [[fallthrough]];
      default: {
        piece.key = {robot, PieceKind::kBrick, brick()};
        BrickPart part;
        for (const world::CellIndex& cell : cells(piece.key.index))
          part.cells.push_back({cell, TopicId{below(6)}, {below(40) * 1'000'000}});
        piece.content = part;
      }
    }
    return piece;
  }

 private:
  int32_t below(int32_t n) { return static_cast<int32_t>(random_.below(static_cast<uint64_t>(n))); }
  std::array<int32_t, 3> brick() { return {below(3) - 1, below(3) - 1, below(2) - 1}; }

  std::set<world::CellIndex> cells(const std::array<int32_t, 3>& brick) {
    std::set<world::CellIndex> cells;
    for (int32_t n = 1 + below(60); n > 0; --n) {
      cells.insert({brick[0] * 16 + below(16), brick[1] * 16 + below(16), brick[2] * 16 + below(3) * 7});
    }
    return cells;
  }

  Piece edit() {
    Edit edit{{"OPERATOR", ++edits_}, {edits_}, {}};
    switch (below(4)) {
      case 3: {
        const TopicRef a{RobotId{below(5) * 3}, 0, TopicId{below(6)}};
        const TopicRef b{RobotId{below(5) * 3}, 0, TopicId{below(6)}};
        if (a != b) {
          edit.operation = LinkEdit{std::min(a, b), std::max(a, b), below(2) == 0};
          break;
        }
        [[fallthrough]];
      }
      case 0:
        edit.operation = ExcludeEdit{RobotId{below(5) * 3}};
        break;
      case 1:
        edit.operation = UndoEdit{{"OPERATOR", 1 + below(edits_)}};
        break;
      default:
        edit.operation =
            NameEdit{{RobotId{below(5) * 3}, 0, TopicId{below(6)}}, "n" + std::to_string(edits_)};
    }
    return pieceOf(edit);
  }

  Random random_;
  std::map<RobotId, int32_t> epoch_;
  int32_t observation_ = 0, edits_ = 0;
};

// However many pieces come between two updates, and whatever they were, the map is that of the state.
TEST(FusedMapTest, EqualsThePlainFusionOfWhateverStateItHasGrownTo) {
  for (uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Mission mission(seed);
    Random random(seed, 1);
    BeliefStore store;
    FusedMap fused;
    const matching::MatcherOptions options =
        seed % 2 == 0 ? matching::usualMatcher() : matching::MatcherOptions{};
    for (int step = 0; step < 60; ++step) {
      for (uint64_t n = random.below(12); n > 0; --n) store.apply(mission.next());
      fused.update(store, options);
      ASSERT_NO_FATAL_FAILURE(expectEqual(fused, fusePlainly(store, options))) << "step " << step;
    }
    expectEqual(fuse(store, options), fusePlainly(store, options));
    const matching::MatcherOptions other{.matcher = "id"};
    fused.update(store, other);
    expectEqual(fused, fusePlainly(store, other));
  }
}

// Told in whatever steps, surprises by place are those of the whole map, and hashes show what changed.
TEST(ToldSurprisesTest, AreThoseOfTheWholeMap) {
  size_t found = 0;
  for (uint64_t seed = 1; seed <= 6; ++seed) {
    SCOPED_TRACE(seed);
    Mission mission(seed);
    Random random(seed, 1);
    BeliefStore store;
    ToldSurprises grown;
    for (int step = 0; step < 40; ++step) {
      for (uint64_t n = random.below(12); n > 0; --n) store.apply(mission.next());
      grown.update(store);
      const GlobalMap map = fusePlainly(store, {});
      const std::vector<uint8_t> steps = grown.of(map.cells);
      ASSERT_EQ(steps.size(), map.cells.size());
      std::vector<SurprisingCell> told;
      for (size_t i = 0; i < steps.size(); ++i)
        if (steps[i] > 0)
          told.push_back({map.cells[i], static_cast<float>(steps[i]) / kSurpriseStepsPerUnit});
      ASSERT_EQ(told, surprisesOf(map, store)) << "step " << step;
      found += told.size();
      ToldSurprises anew;
      anew.update(store);
      for (int32_t x = -2; x <= 2; ++x)
        for (int32_t y = -2; y <= 2; ++y) ASSERT_EQ(grown.hashOf({x, y}), anew.hashOf({x, y}));
    }
  }
  EXPECT_GT(found, 100u);
}

// 255 robots tell of one tile at 256 times each: as many as there is room for.
TEST(FusedMapTest, HasRoomForAsManyRobotsAsAStoreHolds) {
  BeliefStore store;
  for (int32_t r = 0; r < 300; ++r) {
    BrickPart part;
    for (int32_t i = 0; i < 256; ++i)
      part.cells.push_back({{i / 16, i % 16, 0}, TopicId{i % 40}, {int64_t{r} * 256 + i * 7 % 256}});
    store.apply({{RobotId{r}, PieceKind::kBrick, {}}, {0, 1}, 0, 1, part});
  }
  const GlobalMap map = fuse(store, {});
  ASSERT_EQ(map.cells.size(), 256u);
  for (const GlobalCell& c : map.cells) EXPECT_EQ(c.robot, RobotId{254});
}

// Links of labels are a small table: a matching that joins two labels leaves every tile's sums as they are,
// and the digest follows.
TEST(FusedMapTest, ADigestOfSumsIsTheDigestOfTheCells) {
  GlobalMap map;
  for (int32_t i = 0; i < 50; ++i)
    map.cells.push_back({{i, -i, i % 3}, world::GlobalLabel{i % 4}, RobotId{i % 2}, {i}, .5f});
  map.correspondences = {{RobotId{0}, TopicId{1}, world::GlobalLabel{2}}};
  const uint64_t digest = map.digest();
  std::map<world::GlobalLabel, uint64_t> sums;
  for (const GlobalCell& c : map.cells) sums[c.label] += cellHash(c.cell, c.robot, c.seen, c.certainty);
  uint64_t sum = 0;
  for (const auto& [label, hash] : sums) sum += hash * labelFactor(label);
  EXPECT_EQ(mapDigest(sum, map.correspondences), digest);
  for (int what = 0; what < 5; ++what) {  // whatever differs in one cell shows
    GlobalMap other = map;
    GlobalCell& cell = other.cells[7];
    if (what == 0) cell.label = world::GlobalLabel{9};
    if (what == 1) cell.robot = RobotId{9};
    if (what == 2) cell.seen.us = -1;
    if (what == 3) cell.certainty = 0.25f;
    if (what == 4) std::swap(cell.label, other.cells[8].label);
    EXPECT_NE(other.digest(), digest) << what;
  }
}

}  // namespace
}  // namespace shoal::mapping
