// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/dense_search.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::vision {
namespace {

std::vector<int16_t> randomValues(size_t count, int range, uint64_t seed) {
  Random random(seed);
  std::vector<int16_t> values(count);
  for (int16_t& value : values) {
    value =
        static_cast<int16_t>(static_cast<int>(random.below(static_cast<uint64_t>(2 * range + 1))) - range);
  }
  return values;
}

// From the definition, in 64 bits: the first least distance.
int32_t bruteForce(const int16_t* point, const DenseWordList& list) {
  int64_t least = INT64_MAX;
  int32_t nearest = -1;
  for (int32_t word = 0; word < list.numWords(); ++word) {
    int64_t distance = 0;
    for (int d = 0; d < list.dimensions; ++d) {
      const int64_t difference =
          int64_t{point[d]} - list.words[static_cast<size_t>(word * list.dimensions + d)];
      distance += difference * difference;
    }
    if (distance < least) {
      least = distance;
      nearest = word;
    }
  }
  return nearest;
}

class DenseSearchTest : public testing::TestWithParam<DenseSearchPath> {
 protected:
  static void expectBruteForce(const DenseWordList& list, const std::vector<int16_t>& points) {
    const std::vector<int32_t> nearest = DenseSearch(list, GetParam()).nearest(points);
    const auto dimensions = static_cast<size_t>(list.dimensions);
    ASSERT_EQ(nearest.size(), points.size() / dimensions);
    for (size_t i = 0; i < nearest.size(); ++i) {
      ASSERT_EQ(nearest[i], bruteForce(&points[i * dimensions], list))
          << list.numWords() << " words in " << dimensions << " dimensions, point " << i;
    }
  }
};

// Values of 0 to 2 make ties everywhere.
TEST_P(DenseSearchTest, AgreesWithBruteForceForEveryShape) {
  for (int dimensions = 1; dimensions <= 32; ++dimensions) {
    for (const size_t num_words : {1u, 2u, 7u, 8u, 9u, 16u, 23u}) {
      for (const int range : {1, 2, 4095}) {
        const auto d = static_cast<size_t>(dimensions);
        expectBruteForce({"x", dimensions, randomValues(num_words * d, range, 1 + d)},
                         randomValues(20 * d, range, 100 + num_words));
      }
    }
  }
}

TEST_P(DenseSearchTest, AgreesWithBruteForceOnManyWords) {
  expectBruteForce({"x", 30, randomValues(200 * 30, 1024, 1)}, randomValues(300 * 30, 1024, 2));
  expectBruteForce({"x", 2, randomValues(1000 * 2, 60, 3)}, randomValues(500 * 2, 60, 4));
}

// The largest possible distance, 32 x 8190^2, is below 2^31.
TEST_P(DenseSearchTest, HoldsAtTheEndsOfTheRange) {
  const std::vector<int16_t> low(32, -4095), high(32, 4095);
  std::vector<int16_t> both = high;
  both.insert(both.end(), low.begin(), low.end());
  EXPECT_EQ(DenseSearch({"x", 32, high}, GetParam()).nearest(low), std::vector<int32_t>{0});
  EXPECT_EQ(DenseSearch({"x", 32, both}, GetParam()).nearest(low), std::vector<int32_t>{1});
  EXPECT_EQ(squaredDistance(low, high), 2146435200);
}

TEST_P(DenseSearchTest, FindsNothingForNothing) {
  EXPECT_TRUE(DenseSearch({"x", 3, {1, 2, 3}}, GetParam()).nearest({}).empty());
}

std::string pathName(const testing::TestParamInfo<DenseSearchPath>& path) {
  return path.param == DenseSearchPath::kAvx2 ? "Avx2" : "Portable";
}

INSTANTIATE_TEST_SUITE_P(Paths, DenseSearchTest, testing::ValuesIn(availableDenseSearchPaths()), pathName);

}  // namespace
}  // namespace shoal::vision
