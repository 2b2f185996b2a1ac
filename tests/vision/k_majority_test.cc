// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/k_majority.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::vision {
namespace {

// Around each of `centres` descriptors with up to `flips` bits flipped.
std::vector<BinaryWord> around(const std::vector<BinaryWord>& centres, int members, int flips,
                               uint64_t seed) {
  Random random(seed);
  std::vector<BinaryWord> descriptors;
  for (int i = 0; i < members; ++i) {
    for (BinaryWord descriptor : centres) {
      for (int f = 0; f < flips; ++f) descriptor[random.below(4)] ^= uint64_t{1} << random.below(64);
      descriptors.push_back(descriptor);
    }
  }
  return descriptors;
}

std::vector<BinaryWord> randomCentres(size_t count, uint64_t seed) {
  Random random(seed);
  std::vector<BinaryWord> centres(count);
  for (BinaryWord& centre : centres) {
    for (uint64_t& part : centre) part = random();
  }
  std::sort(centres.begin(), centres.end());
  return centres;
}

// One word: the majority of 011, 001, 111 and 001 bit by bit is 001; the middle bit is a tie.
TEST(KMajorityTest, TakesTheMajorityOfEachBit) {
  const std::vector<BinaryWord> descriptors{{1, 0, 0, 0}, {1, 0, 0, 0}, {5, 0, 0, 0}};
  const auto result = kMajority(descriptors, {.num_words = 1});
  EXPECT_EQ(result.words, (std::vector<BinaryWord>{{1, 0, 0, 0}}));
  EXPECT_NEAR(result.mean_distance, 1.0 / 3.0, 1e-12);
}

// Recovers what was put in: with random centres 100 bits and more apart, and 20 flips, the majority of 60
// members is the centre itself. Some seeds start with two words in one cluster and stay there, so the best of
// ten counts.
TEST(KMajorityTest, RecoversPlantedCentres) {
  const auto centres = randomCentres(4, 1);
  const auto descriptors = around(centres, 60, 20, 2);
  double best_distance = 256.0;
  std::vector<BinaryWord> best;
  for (uint64_t seed = 1; seed <= 10; ++seed) {
    const auto result = kMajority(descriptors, {.num_words = 4, .seed = seed});
    if (result.mean_distance < best_distance) {
      best_distance = result.mean_distance;
      best = result.words;
    }
  }
  EXPECT_EQ(best, centres);
}

TEST(KMajorityTest, NeverIncreasesTheMeanDistanceUntilItStops) {
  const auto descriptors = around(randomCentres(40, 3), 10, 50, 4);
  double last = 257.0;
  int64_t last_changed = -1;
  const auto result = kMajority(descriptors, {.num_words = 30, .max_rounds = 100},
                                [&](int, int64_t changed, double distance) {
                                  EXPECT_LE(distance, last);
                                  last = distance;
                                  last_changed = changed;
                                });
  EXPECT_LT(result.rounds, 100);
  EXPECT_EQ(last_changed, 0);
  EXPECT_EQ(result.mean_distance, last);
}

TEST(KMajorityTest, GivesTheSameWordsForTheSameSeed) {
  const auto descriptors = around(randomCentres(20, 5), 10, 40, 6);
  const KMajorityOptions options{.num_words = 15, .seed = 3};
  EXPECT_EQ(kMajority(descriptors, options).words, kMajority(descriptors, options).words);
  EXPECT_NE(kMajority(descriptors, options).words,
            kMajority(descriptors, {.num_words = 15, .seed = 4}).words);
}

// As many words as distinct descriptors: each is its own word.
TEST(KMajorityTest, KeepsEveryDescriptorWhenThereAreAsManyWords) {
  auto descriptors = randomCentres(12, 7);
  const auto expected = descriptors;
  descriptors.push_back(descriptors.front());
  EXPECT_EQ(kMajority(descriptors, {.num_words = 12}).words, expected);
}

// Two start words between which every descriptor prefers one: the other one moves to the farthest descriptor.
TEST(KMajorityTest, LeavesNoWordWithoutMembers) {
  const auto descriptors = around(randomCentres(3, 8), 30, 30, 9);
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const auto words = kMajority(descriptors, {.num_words = 25, .max_rounds = 50, .seed = seed}).words;
    EXPECT_EQ(std::adjacent_find(words.begin(), words.end()), words.end())
        << "two equal words, seed " << seed;
  }
}

TEST(KMajorityTest, RefusesWhatCannotBeClustered) {
  const std::vector<BinaryWord> descriptors{{1, 0, 0, 0}, {1, 0, 0, 0}, {2, 0, 0, 0}};
  EXPECT_THROW(kMajority(descriptors, {.num_words = 3}), std::invalid_argument);
  EXPECT_THROW(kMajority(descriptors, {.num_words = 0}), std::invalid_argument);
  EXPECT_THROW(kMajority(descriptors, {.num_words = 1, .max_rounds = 0}), std::invalid_argument);
  EXPECT_THROW(kMajority({}, {.num_words = 1}), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::vision
