// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/placement.h"

#include <limits>
#include <map>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "pictures.h"
#include "shoal/random.h"

namespace shoal::vision {
namespace {

using world::CellIndex;

world::Observation flat(double altitude_m) {
  return seenFromAbove(cv::Mat(240, 320, CV_8UC3, cv::Scalar(1, 2, 3)), altitude_m);
}

std::vector<CellIndex> cells(const world::WordsInCells& words) {
  std::vector<CellIndex> result;
  for (const auto& cell : words.cells) result.push_back(cell.cell);
  return result;
}

// By hand: from 4 m with fx 200 pixel (u, v) lies at X = (u - 159.5) / 50, Y = -(v - 119.5) / 50. Pixel (210,
// 19) is at (1.01, 2.01, 0): with cells of 0.8 m in cell (1, 3, 0).
TEST(PlaceWordsTest, FollowsAWordWorkedByHand) {
  const auto placed = placeWords({{{210, 19, 42}}}, flat(4.0), world::Grid(0.8));
  ASSERT_EQ(cells(placed), (std::vector<CellIndex>{{1, 3, 0}}));
  EXPECT_EQ(placed.cells[0].words, (std::vector<world::WordCount>{{42, 1}}));
  EXPECT_EQ(placed.observation, 7);
  EXPECT_EQ(placed.time, world::Timestamp{7'000'000});
  EXPECT_EQ(placed.dropped_words, 0);
}

// A pixel that is 1 m nearer lies 1 m higher and nearer to the axis: (0.7575, 1.5075, 1), cell (1, 2, 1).
TEST(PlaceWordsTest, UsesTheDepthOfThePixelItself) {
  auto observation = flat(4.0);
  observation.depth_m.at<float>(19, 210) = 3.0f;
  EXPECT_EQ(cells(placeWords({{{210, 19, 42}}}, observation, world::Grid(0.8))),
            (std::vector<CellIndex>{{1, 2, 1}}));
}

// Turned left by 90 degrees, image right is world +Y and image down is world +X: (1.01, 2.01) becomes
// (-2.01, 1.01), and the camera stands at (10, 20).
TEST(PlaceWordsTest, GoesThroughThePose) {
  auto observation = flat(4.0);
  observation.world_from_camera = world::lookingDown({10.0, 20.0, 4.0}, 1.5707963267948966);
  EXPECT_EQ(cells(placeWords({{{210, 19, 42}}}, observation, world::Grid(0.8))),
            (std::vector<CellIndex>{{10, 26, 0}}));
}

TEST(PlaceWordsTest, DropsAndCountsWordsWithoutDepth) {
  auto observation = flat(4.0);
  const float infinity = std::numeric_limits<float>::infinity();
  const std::vector<float> bad{0.0f, -1.0f, std::numeric_limits<float>::quiet_NaN(), infinity, -infinity};
  std::vector<PixelWord> words{{100, 50, 1}};
  for (int i = 0; i < static_cast<int>(bad.size()); ++i) {
    observation.depth_m.at<float>(10, i) = bad[static_cast<size_t>(i)];
    words.push_back({i, 10, 2});
  }
  const auto placed = placeWords(words, observation, world::Grid(0.8));
  EXPECT_EQ(placed.dropped_words, 5);
  ASSERT_EQ(placed.cells.size(), 1u);
  EXPECT_EQ(placed.cells[0].words, (std::vector<world::WordCount>{{1, 1}}));
}

// A depth that is finite but out of this world must not overflow a cell index.
TEST(PlaceWordsTest, DropsWordsBeyondWhatACellIndexCounts) {
  auto observation = flat(4.0);
  observation.depth_m.at<float>(10, 10) = std::numeric_limits<float>::max();
  const auto placed = placeWords({{{10, 10, 1}}}, observation, world::Grid(0.8));
  EXPECT_EQ(placed.dropped_words, 1);
  EXPECT_TRUE(placed.cells.empty());
}

// Against a map filled word by word, in any order of the words.
TEST(PlaceWordsTest, CountsAndSortsWhateverTheOrder) {
  const auto observation = flat(4.0);
  const world::Grid grid(0.5);
  Random random(3);
  std::vector<PixelWord> words;
  std::map<CellIndex, std::map<int32_t, int32_t>> expected;
  for (int i = 0; i < 2000; ++i) {
    const PixelWord word{static_cast<int>(random.below(320)), static_cast<int>(random.below(240)),
                         static_cast<int32_t>(random.below(50))};
    words.push_back(word);
    ++expected[grid.cellOf({(word.u - 159.5) / 50.0, -(word.v - 119.5) / 50.0, 0.0})][word.word];
  }
  const auto placed = placeWords(words, observation, grid);
  ASSERT_EQ(placed.cells.size(), expected.size());
  size_t c = 0;
  for (const auto& [cell, counts] : expected) {
    EXPECT_EQ(placed.cells[c].cell, cell);
    std::vector<world::WordCount> expected_words;
    for (const auto& [word, count] : counts) expected_words.push_back({word, count});
    EXPECT_EQ(placed.cells[c++].words, expected_words);
  }
  std::vector<PixelWord> reversed(words.rbegin(), words.rend());
  const auto again = placeWords(reversed, observation, grid);
  ASSERT_EQ(cells(again), cells(placed));
  for (size_t i = 0; i < again.cells.size(); ++i) EXPECT_EQ(again.cells[i].words, placed.cells[i].words);
}

TEST(PlaceWordsTest, RefusesImagesThatDoNotFitTogether) {
  const auto refused = [](auto&& spoil) {
    auto observation = flat(4.0);
    spoil(observation);
    EXPECT_THROW(placeWords({}, observation, world::Grid(0.8)), std::invalid_argument);
  };
  refused([](auto& o) { o.color = cv::Mat(); });
  refused([](auto& o) { o.color = cv::Mat(240, 320, CV_8UC1, cv::Scalar(1)); });
  refused([](auto& o) { o.color = cv::Mat(240, 319, CV_8UC3, cv::Scalar(1)); });
  refused([](auto& o) { o.depth_m = cv::Mat(); });
  refused([](auto& o) { o.depth_m = cv::Mat(120, 160, CV_32FC1, cv::Scalar(4)); });
  refused([](auto& o) { o.depth_m = cv::Mat(240, 320, CV_64FC1, cv::Scalar(4)); });
  refused([](auto& o) { o.depth_m = cv::Mat(240, 320, CV_16UC1, cv::Scalar(4)); });
  refused([](auto& o) { o.intrinsics.width = 640; });
  refused([](auto& o) { o.intrinsics.fx = 0.0; });
  refused([](auto& o) { o.intrinsics.cy = std::numeric_limits<double>::quiet_NaN(); });
  refused([](auto& o) { o.world_from_camera.translation().x() = std::numeric_limits<double>::infinity(); });
}

}  // namespace
}  // namespace shoal::vision
