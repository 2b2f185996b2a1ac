// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "planted_map.h"
#include "shoal/random.h"
#include "shoal/topics/state_bytes.h"
#include "shoal/topics/topic_model.h"

namespace shoal::topics {
namespace {

using world::RobotId;
using Bytes = std::vector<uint8_t>;

constexpr int32_t kVocabulary = 100;

Hyperparameters settings(double gamma) {
  Hyperparameters h;
  h.gamma = gamma;
  h.resamples_per_observation = 3001;  // not a whole number of cells: leaves an overrun
  return h;
}

TopicModel made(double gamma = 0) { return {settings(gamma), kVocabulary, 7, RobotId{3}}; }
TopicModel resumed(const Bytes& bytes, double gamma = 0) {
  return TopicModel::resumed(settings(gamma), kVocabulary, 7, RobotId{3}, bytes);
}

bool refused(const Bytes& bytes) {
  try {
    resumed(bytes);
  } catch (const std::runtime_error&) {
    return true;
  }
  return false;
}

// Fixed K and growing K.
class EveryGrowth : public ::testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(Gammas, EveryGrowth, ::testing::Values(0.0, 1e-3));

// Checkpoints hold all there is, so equal checkpoints are equal models.
TEST_P(EveryGrowth, ResumingEqualsNeverHavingStopped) {
  TopicModel model = made(GetParam());
  std::optional<TopicModel> stopped(made(GetParam()));
  PlantedMap map(3, 4);
  for (int32_t n = 0; n < 8; ++n) {
    const world::WordsInCells image = map.image(n);
    for (TopicModel* m : {&model, &*stopped}) {
      m->observe(image);
      if (n == 3) m->adopt({{std::nullopt, {{1, 40}, {50, 7}}}, {m->snapshot().topics[0].id, {{99, 3}}}});
    }
    const Bytes kept = stopped->checkpoint();
    stopped.emplace(resumed(kept, GetParam()));
    ASSERT_EQ(stopped->checkpoint(), kept);
    ASSERT_EQ(kept, model.checkpoint());
    const Snapshot a = stopped->snapshot(), b = model.snapshot();
    ASSERT_EQ(a.topics.size(), b.topics.size());
    for (size_t k = 0; k < a.topics.size(); ++k) {
      EXPECT_EQ(a.topics[k].id, b.topics[k].id);
      EXPECT_EQ(a.topics[k].words, b.topics[k].words);
    }
    ASSERT_EQ(a.cells.size(), b.cells.size());
    for (size_t c = 0; c < a.cells.size(); ++c) {
      EXPECT_EQ(a.cells[c].topic, b.cells[c].topic);
      EXPECT_EQ(a.cells[c].certainty, b.cells[c].certainty);
    }
  }
  EXPECT_NO_THROW(stopped->adopt({}));  // takes out again what was adopted before
}

TEST(TopicModelCheckpointTest, AnEmptyModelResumesToo) {
  EXPECT_EQ(resumed(made().checkpoint()).checkpoint(), made().checkpoint());
}

// A small model, two topics of its own and one adopted.
Bytes small() {
  TopicModel model = made();
  world::WordsInCells image{.observation = 0, .time = {}, .cells = {}};
  for (int32_t x = 0; x < 3; ++x) image.cells.push_back({{x, 0, 0}, {{x, 2}, {50, 1}}});
  model.observe(image);
  model.adopt({{std::nullopt, {{4, 2}}}});
  return model.checkpoint();
}

TEST(TopicModelCheckpointTest, RefusesEveryTruncationFlippedByteAndAnotherModel) {
  const Bytes whole = small();
  EXPECT_FALSE(refused(whole));
  for (size_t length = 0; length < whole.size(); ++length) {
    EXPECT_TRUE(refused({whole.begin(), whole.begin() + static_cast<ptrdiff_t>(length)})) << length;
  }
  for (size_t at = 0; at < whole.size(); ++at) {
    Bytes broken = whole;
    broken[at] ^= 0x10;
    EXPECT_TRUE(refused(broken)) << at;
  }
  for (const auto& [vocabulary, seed, robot] : {std::tuple{101, 7, 3}, {100, 8, 3}, {100, 7, 4}}) {
    EXPECT_THROW(
        TopicModel::resumed(settings(0), vocabulary, static_cast<uint64_t>(seed), RobotId{robot}, whole),
        std::runtime_error);
  }
  EXPECT_THROW(resumed(whole, 1e-3), std::runtime_error);
}

// Whoever makes the checksum fit can still not break in: damaged numbers are refused or give a model that
// works.
TEST(TopicModelCheckpointTest, LiesWithAFittingChecksumDoNoHarm) {
  const Bytes whole = small();
  constexpr size_t kFront = 8 + 4, kChecksum = 8;
  const auto withChecksum = [](const Bytes& bytes) {
    StateWriter out("shoalTPM", 3);
    for (size_t at = kFront; at + kChecksum < bytes.size(); at += 4) {
      out.u32(bytes[at] | uint32_t{bytes[at + 1]} << 8 | uint32_t{bytes[at + 2]} << 16 |
              uint32_t{bytes[at + 3]} << 24);
    }
    return std::move(out).finish();
  };
  ASSERT_EQ(withChecksum(whole), whole);
  int num_refused = 0;
  for (size_t at = kFront; at + kChecksum < whole.size(); ++at) {
    for (const uint8_t flip : Bytes{0x01, 0x80, 0xff}) {
      Bytes lie = whole;
      lie[at] ^= flip;
      try {
        TopicModel fooled = resumed(withChecksum(lie));
        fooled.refine(50);
        fooled.snapshot();
        fooled.adopt({});
      } catch (const std::runtime_error&) {
        ++num_refused;
      }
    }
  }
  EXPECT_GT(num_refused, 300);
}

}  // namespace
}  // namespace shoal::topics
