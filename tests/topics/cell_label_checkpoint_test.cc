// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "planted_map.h"
#include "shoal/random.h"
#include "shoal/topics/cell_label_model.h"

namespace shoal::topics {
namespace {

using world::RobotId;
using Bytes = std::vector<uint8_t>;

constexpr CellLabelHyperparameters kSettings{.max_topics = 20, .cells_per_topic = 10, .evidence = 3};

CellLabelModel made() { return {kSettings, PlantedMap::groups(), 7, RobotId{3}}; }
CellLabelModel resumed(const Bytes& bytes) {
  return CellLabelModel::resumed(kSettings, PlantedMap::groups(), 7, RobotId{3}, bytes);
}

std::string complaint(const Bytes& bytes) {
  try {
    resumed(bytes);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "";
}

// Checkpoints hold all there is, so equal checkpoints are equal models.
TEST(CellLabelCheckpointTest, ResumingEqualsNeverHavingStopped) {
  CellLabelModel model = made();
  std::optional<CellLabelModel> stopped(made());
  PlantedMap map(3, 4);
  for (int32_t n = 0; n < 12; ++n) {
    const world::WordsInCells image = map.image(n);
    model.observe(image);
    stopped->observe(image);
    const Bytes kept = stopped->checkpoint();
    stopped.emplace(resumed(kept));
    EXPECT_EQ(stopped->checkpoint(), model.checkpoint());
    const Snapshot a = stopped->snapshot(), b = model.snapshot();
    ASSERT_EQ(a.topics.size(), b.topics.size());
    for (size_t k = 0; k < a.topics.size(); ++k) {
      EXPECT_EQ(a.topics[k].id, b.topics[k].id);
      EXPECT_EQ(a.topics[k].created, b.topics[k].created);
      EXPECT_EQ(a.topics[k].words, b.topics[k].words);
    }
    ASSERT_EQ(a.cells.size(), b.cells.size());
    for (size_t c = 0; c < a.cells.size(); ++c) {
      EXPECT_EQ(a.cells[c].topic, b.cells[c].topic);
      EXPECT_EQ(a.cells[c].certainty, b.cells[c].certainty);
      EXPECT_EQ(a.cells[c].seen, b.cells[c].seen);
    }
  }
  EXPECT_GT(number(model.snapshot().topics.back().id), 20);  // some topics had retired
}

TEST(CellLabelCheckpointTest, AnEmptyModelResumesToo) {
  EXPECT_EQ(resumed(made().checkpoint()).checkpoint(), made().checkpoint());
}

TEST(CellLabelCheckpointTest, RefusesEveryTruncationAndEveryFlippedByte) {
  CellLabelModel model = made();
  PlantedMap map(3, 4);
  world::WordsInCells image = map.image(0);
  image.cells.resize(3);
  model.observe(image);
  const Bytes whole = model.checkpoint();
  EXPECT_EQ(complaint(whole), "");
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_NE(complaint(Bytes(whole.begin(), whole.begin() + static_cast<ptrdiff_t>(length))), "") << length;
  }
  for (size_t at = 0; at < whole.size(); ++at) {
    Bytes broken = whole;
    broken[at] ^= 0x10;
    EXPECT_NE(complaint(broken), "") << at;
  }
  Bytes longer = whole;
  longer.push_back(0);
  EXPECT_NE(complaint(longer), "");
}

TEST(CellLabelCheckpointTest, SaysWhatIsWrong) {
  const Bytes whole = made().checkpoint();
  Bytes other = whole;
  other[0] ^= 1;
  EXPECT_NE(complaint(other).find("another kind"), std::string::npos);
  other = whole;
  other[8] = 1;
  EXPECT_NE(complaint(other).find("version is 1"), std::string::npos);
  other = whole;
  other.back() ^= 1;
  EXPECT_NE(complaint(other).find("checksum"), std::string::npos);
  EXPECT_THROW(CellLabelModel::resumed(kSettings, PlantedMap::groups(), 8, RobotId{3}, whole),
               std::runtime_error);
  EXPECT_THROW(CellLabelModel::resumed(kSettings, PlantedMap::groups(), 7, RobotId{4}, whole),
               std::runtime_error);
  EXPECT_THROW(CellLabelModel::resumed({}, PlantedMap::groups(), 7, RobotId{3}, whole), std::runtime_error);
  EXPECT_THROW(
      CellLabelModel::resumed(kSettings, {{.name = "all", .first = 0, .size = 100}}, 7, RobotId{3}, whole),
      std::runtime_error);
}

// Whoever makes the checksum fit can still not break in: damaged numbers are refused or give a model that
// works.
TEST(CellLabelCheckpointTest, LiesWithAFittingChecksumDoNoHarm) {
  CellLabelModel model = made();
  PlantedMap map(3, 4);
  world::WordsInCells image = map.image(0);
  image.cells.resize(5);
  model.observe(image);
  const Bytes whole = model.checkpoint();
  const auto withChecksum = [](Bytes bytes) {
    bytes.erase(bytes.end() - 8, bytes.end());
    uint64_t hash = bytes.size();
    for (size_t first = 0; first < bytes.size(); first += 8) {
      uint64_t word = 0;
      for (size_t i = first; i < bytes.size() && i < first + 8; ++i)
        word |= uint64_t{bytes[i]} << 8 * (i - first);
      hash = hashCombine(hash, word);
    }
    for (int i = 0; i < 8; ++i) bytes.push_back(static_cast<uint8_t>(hash >> 8 * i));
    return bytes;
  };
  EXPECT_EQ(withChecksum(whole), whole);
  int refused = 0;
  for (size_t at = 12; at + 8 < whole.size(); ++at) {
    for (const uint8_t flip : Bytes{0x01, 0x80, 0xff}) {
      Bytes lie = whole;
      lie[at] ^= flip;
      try {
        CellLabelModel fooled = resumed(withChecksum(lie));
        fooled.refine(5);
        fooled.snapshot();
      } catch (const std::runtime_error&) {
        ++refused;
      }
    }
  }
  EXPECT_GT(refused, 500);
}

}  // namespace
}  // namespace shoal::topics
