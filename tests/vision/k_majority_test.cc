// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/k_majority.h"

#include <algorithm>
#include <set>
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

// One word for 001, 001 and 101: the lowest bit is set in all, the highest in one of three.
TEST(KMajorityTest, TakesTheMajorityOfEachBit) {
  const std::vector<BinaryWord> descriptors{{1, 0, 0, 0}, {1, 0, 0, 0}, {5, 0, 0, 0}};
  for (uint64_t seed = 0; seed < 8; ++seed) {  // whichever it starts from
    const auto result = kMajority(descriptors, {.num_words = 1, .seed = seed});
    EXPECT_EQ(result.words, (std::vector<BinaryWord>{{1, 0, 0, 0}}));
    EXPECT_NEAR(result.mean_distance, 1.0 / 3.0, 1e-12);
  }
}

// One word for 0 and 1: the bit is a tie, so the word stays the one it started from.
TEST(KMajorityTest, KeepsABitThatIsATie) {
  std::set<BinaryWord> words;
  for (uint64_t seed = 0; seed < 16; ++seed) {
    words.insert(kMajority({{BinaryWord{0, 0, 0, 0}, BinaryWord{1, 0, 0, 0}}}, {.num_words = 1, .seed = seed})
                     .words[0]);
  }
  EXPECT_EQ(words, (std::set<BinaryWord>{{0, 0, 0, 0}, {1, 0, 0, 0}}));
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

// From the start words 111000 and 000111 (some seed draws them) each gets the three descriptors of one bit on
// its side, twice. Every bit is then set in 3 of 7: both words become 0, and the second never gets a member
// again.
TEST(KMajorityTest, MovesAWordWithoutMembersElsewhere) {
  std::vector<BinaryWord> descriptors{{0b111000, 0, 0, 0}, {0b000111, 0, 0, 0}};
  for (uint64_t bit = 0; bit < 6; ++bit)
    descriptors.insert(descriptors.end(), 2, {uint64_t{1} << bit, 0, 0, 0});
  for (uint64_t seed = 0; seed < 300; ++seed) {
    const auto words = kMajority(descriptors, {.num_words = 2, .seed = seed}).words;
    EXPECT_NE(words[0], words[1]) << "seed " << seed;
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
