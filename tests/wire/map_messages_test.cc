// SPDX-License-Identifier: BSD-3-Clause
// What a fused map becomes on the wire: correspondences, legend and cells.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <stdexcept>

#include "examples.h"
#include "shoal/wire/labels_codec.h"
#include "shoal/wire/map_codec.h"
#include "shoal/wire/matches_codec.h"

namespace shoal::wire {
namespace {

using mapping::Correspondence;
using mapping::GlobalCell;
using mapping::GlobalMap;
using mapping::LabelSummary;
using world::GlobalLabel;
using world::RobotId;
using world::TopicId;

constexpr uint64_t kDigest = 0xfeedfacecafebeef;

int below(Random& random, int n) { return static_cast<int>(random.below(static_cast<uint64_t>(n))); }

std::vector<Correspondence> randomMatches(int num_robots, int max_topic, double share, Random& random) {
  std::vector<Correspondence> list;
  for (int r = 0; r < num_robots; ++r)
    for (int t = 0; t <= max_topic; ++t)
      if (random.uniform() < share)
        list.push_back(
            {RobotId{r * 9999 / std::max(num_robots - 1, 1)}, TopicId{t},
             world::globalLabel(RobotId{below(random, r + 1)}, TopicId{below(random, max_topic + 1)})});
  return list;
}

TEST(MatchesCodecTest, ChunksMakeTheListAgain) {
  Random random(1);
  for (const size_t max_payload : {120u, 400u, 1391u}) {
    for (const int robots : {1, 2, 12, 100}) {
      const auto list = randomMatches(robots, 30, 0.5, random);
      const auto messages = encodeMatches(list, kDigest, 7, {8}, max_payload);
      std::vector<Correspondence> joined;
      for (size_t i = 0; i < messages.size(); ++i) {
        EXPECT_LE(messages[i].size(), max_payload);
        const auto chunk = decodeMatches(messages[i]);
        ASSERT_TRUE(chunk.ok()) << name(chunk.error());
        EXPECT_EQ(chunk->map_digest, kDigest);
        EXPECT_EQ(chunk->chunk, static_cast<int32_t>(i));
        EXPECT_EQ(chunk->num_chunks, static_cast<int32_t>(messages.size()));
        joined.insert(joined.end(), chunk->correspondences.begin(), chunk->correspondences.end());
      }
      EXPECT_EQ(joined, list);
    }
  }
}

TEST(MatchesCodecTest, TwelveRobotsFitInOneMessage) {
  Random random(2);
  EXPECT_EQ(encodeMatches(randomMatches(12, 11, 1.0, random), kDigest, 7, {8}).size(), 1u);
}

TEST(MatchesCodecTest, AnEmptyListIsAMessage) {
  const auto messages = encodeMatches({}, kDigest, 7, {8});
  ASSERT_EQ(messages.size(), 1u);
  const auto chunk = decodeMatches(messages[0]);
  ASSERT_TRUE(chunk.ok());
  EXPECT_TRUE(chunk->correspondences.empty());
  EXPECT_EQ(chunk->num_chunks, 1);
}

TEST(MatchesCodecTest, RefusesBadLists) {
  const Correspondence good{RobotId{1}, TopicId{2}, GlobalLabel{3}};
  const auto refuse = [](std::vector<Correspondence> list) {
    EXPECT_THROW(encodeMatches(list, 0, 0, {}), std::invalid_argument);
  };
  refuse({good, good});
  refuse({good, {RobotId{0}, TopicId{5}, GlobalLabel{3}}});
  refuse({{RobotId{-1}, TopicId{2}, GlobalLabel{3}}});
  refuse({{RobotId{1}, TopicId{10000}, GlobalLabel{3}}});
  refuse({{RobotId{1}, TopicId{2}, GlobalLabel{-3}}});
  EXPECT_THROW(encodeMatches(std::vector{good}, 0, 0, {}, 30), std::invalid_argument);
}

std::vector<LabelSummary> randomLabels(int count, Random& random) {
  std::vector<LabelSummary> rows;
  std::set<int32_t> labels;
  while (static_cast<int>(labels.size()) < count) labels.insert(below(random, 100'000'000));
  for (const int32_t label : labels) {
    LabelSummary row{
        GlobalLabel{label}, "", static_cast<int64_t>(random.below(1u << below(random, 30))), {}, {}};
    if (random.below(2) == 0)
      row.name = std::string(random.below(65), static_cast<char>('a' + random.below(26)));
    for (int r = below(random, 400); r < 10000 && row.robots.size() < 200; r += 1 + below(random, 3000))
      row.robots.push_back(RobotId{r});
    row.first_seen.us = random.below(9) == 0 ? kMaxTimeUs : static_cast<int64_t>(random.below(1'000'000'000));
    rows.push_back(row);
  }
  return rows;
}

TEST(LabelsCodecTest, ChunksMakeTheLegendAgain) {
  Random random(3);
  for (const int count : {0, 1, 20, 300}) {
    const auto rows = randomLabels(count, random);
    std::vector<LabelSummary> joined;
    const auto messages = encodeLabels(rows, kDigest, 7, {8}, 900);
    for (const Bytes& message : messages) {
      EXPECT_LE(message.size(), 900u);
      const auto chunk = decodeLabels(message);
      ASSERT_TRUE(chunk.ok()) << name(chunk.error());
      EXPECT_EQ(chunk->map_digest, kDigest);
      EXPECT_EQ(chunk->num_chunks, static_cast<int32_t>(messages.size()));
      joined.insert(joined.end(), chunk->labels.begin(), chunk->labels.end());
    }
    EXPECT_TRUE(joined == rows);
  }
}

TEST(LabelsCodecTest, KnowsWhatIsAName) {
  for (const char* good : {"", "sand", "Seegr\xc3\xa4ser", "\xe7\xa0\x82", "\xf0\x9f\x90\x9f"})
    EXPECT_TRUE(isName(good)) << good;
  EXPECT_TRUE(isName(std::string(64, 'x')));
  EXPECT_FALSE(isName(std::string(65, 'x')));
  for (const char* bad : {"a\nb", "\x1b[31m", "\x7f", "\xc2\x9b", "\xc0\xaf", "\xe0\x80\xaf", "\xed\xa0\x80",
                          "\xf4\x90\x80\x80", "\xc3", "\x80", "\xff"})
    EXPECT_FALSE(isName(bad)) << bad;
}

TEST(LabelsCodecTest, RefusesBadRows) {
  const LabelSummary good{GlobalLabel{3}, "sand", 1, {RobotId{1}}, {5}};
  const auto refuse = [&](auto change) {
    LabelSummary row = good;
    change(row);
    EXPECT_THROW(encodeLabels(std::vector{row}, 0, 0, {}), std::invalid_argument);
  };
  refuse([](LabelSummary& row) { row.label = GlobalLabel{-1}; });
  refuse([](LabelSummary& row) { row.name = "a\tb"; });
  refuse([](LabelSummary& row) { row.cells = -1; });
  refuse([](LabelSummary& row) { row.robots = {RobotId{2}, RobotId{1}}; });
  refuse([](LabelSummary& row) { row.first_seen.us = -1; });
  EXPECT_THROW(encodeLabels(std::vector{good, good}, 0, 0, {}), std::invalid_argument);
}

GlobalMap randomMap(int width, double density, Random& random) {
  GlobalMap map;
  for (int x = -width; x < width; ++x)
    for (int y = -width; y < width; ++y)
      if (random.uniform() < density)
        map.cells.push_back({{x, y, below(random, 3) - 1},
                             GlobalLabel{10000 * ((x & 64) / 64) + (y & 32) / 32},
                             RobotId{below(random, 3)},
                             {static_cast<int64_t>(1'000'000) * (x + width)},
                             static_cast<float>(below(random, 64)) / 63.0f});
  return map;
}

TEST(MapCodecTest, ChunksMakeTheMapAgain) {
  Random random(4);
  for (const double density : {0.0, 0.05, 1.0}) {
    for (const size_t max_payload : {300u, 1391u}) {
      const GlobalMap map = randomMap(40, density, random);
      const auto messages = encodeMap(map, kDigest, 7, {8}, max_payload);
      std::vector<GlobalCell> joined;
      for (size_t i = 0; i < messages.size(); ++i) {
        EXPECT_LE(messages[i].size(), max_payload);
        const auto chunk = decodeMap(messages[i]);
        ASSERT_TRUE(chunk.ok()) << name(chunk.error());
        EXPECT_EQ(chunk->chunk, static_cast<int32_t>(i));
        EXPECT_EQ(chunk->num_chunks, static_cast<int32_t>(messages.size()));
        EXPECT_EQ(chunk->map_digest, kDigest);
        joined.insert(joined.end(), chunk->cells.begin(), chunk->cells.end());
      }
      std::sort(joined.begin(), joined.end(), [](const auto& a, const auto& b) { return a.cell < b.cell; });
      EXPECT_TRUE(joined == map.cells);
    }
  }
}

// All 64 steps are fixed points; in between, the nearest step.
TEST(MapCodecTest, RoundsCertaintiesToSteps) {
  for (int s = 0; s <= 63; ++s) EXPECT_EQ(certaintySteps(static_cast<float>(s) / 63.0f), s);
  EXPECT_EQ(certaintySteps(0.5f / 63.0f - 1e-4f), 0);
  EXPECT_EQ(certaintySteps(0.5f / 63.0f + 1e-4f), 1);
}

TEST(MapCodecTest, RefusesBadMaps) {
  const GlobalCell good{{1, 2, 3}, GlobalLabel{4}, RobotId{5}, {6}, 0.5f};
  const auto refuse = [&](auto change) {
    GlobalMap map;
    map.cells = {good};
    change(map.cells);
    EXPECT_THROW(encodeMap(map, 0, 0, {}), std::invalid_argument);
  };
  refuse([](auto& cells) { cells.push_back(cells[0]); });
  refuse([](auto& cells) { cells[0].label = GlobalLabel{-1}; });
  refuse([](auto& cells) { cells[0].robot = RobotId{10000}; });
  refuse([](auto& cells) { cells[0].seen.us = -1; });
  refuse([](auto& cells) { cells[0].certainty = 1.01f; });
}

}  // namespace
}  // namespace shoal::wire
