// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"
#include "shoal/world/ortho_world.h"

namespace shoal::world {
namespace {

/// A world of labels alone, given row by row.
OrthoWorld labelled(const std::vector<std::vector<int>>& rows, double metres_per_pixel = 1.0) {
  const int height = static_cast<int>(rows.size()), width = static_cast<int>(rows[0].size());
  cv::Mat labels(height, width, CV_8UC1);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      labels.at<uint8_t>(y, x) = static_cast<uint8_t>(rows[static_cast<size_t>(y)][static_cast<size_t>(x)]);
    }
  }
  std::vector<TruthClass> classes;
  for (int id = 0; id < 10; ++id) classes.push_back({id, "c", {}});
  return OrthoWorld("w", cv::Mat(height, width, CV_8UC3, cv::Scalar::all(9)), labels, metres_per_pixel,
                    classes);
}

constexpr int kNone = 255;

// Cells of two pixels: [-1, 1) x [-1, 1) holds X = -1, 0 and Y = -1, 0; X = -1 and Y > 0 lie outside.
//      X  0 1 2 3          cell (1, -1): X in [1, 3), Y in [-3, -1): py 2 and 3
TEST(TruthOfSquareTest, HoldsThePixelsWhoseCentresLieInTheHalfOpenSquare) {
  const OrthoWorld world = labelled({{1, 2, 2, 4},  // Y =  0
                                     {5, 6, 6, 8},  // Y = -1
                                     {5, 3, 3, 8},  // Y = -2
                                     {5, 3, 3, 8}});
  const Grid grid(2.0);
  EXPECT_EQ(world.truthOfSquare(grid, {1, -1, 0}), 3);  // py 2, 3
  EXPECT_EQ(world.truthOfSquare(grid, {1, 0, 0}), 2);   // py 0, 1: 2 2 6 6, a tie for the lowest id
  EXPECT_EQ(world.truthOfSquare(grid, {2, -1, 0}), 8);  // px 3 alone: two of four labelled are half
  EXPECT_EQ(world.truthOfSquare(grid, {0, 0, 0}), 1);   // px 0: 1 5, half of the square, a tie
  EXPECT_EQ(world.truthOfSquare(grid, {0, -2, 0}), kNone);
  EXPECT_EQ(world.truthOfSquare(grid, {2, 1, 0}), kNone);
}

TEST(TruthOfSquareTest, TakesTheMajorityAndTheLowestIdOfATie) {
  const Grid grid(3.0);  // cell (1, -1): px 2..4, py 2..4
  const auto truth = [&](std::vector<int> nine) {
    std::vector<std::vector<int>> rows(6, std::vector<int>(6, 9));
    for (size_t i = 0; i < 9; ++i) rows[2 + i / 3][2 + i % 3] = nine[i];
    return labelled(rows).truthOfSquare(grid, {1, -1, 0});
  };
  EXPECT_EQ(truth({4, 4, 4, 4, 1, 1, 1, 0, 0}), 4);
  EXPECT_EQ(truth({4, 4, 4, 1, 1, 1, 7, 7, 7}), 1);
  EXPECT_EQ(truth({255, 255, 255, 255, 4, 4, 4, 1, 1}), 4);  // five of nine labelled
  EXPECT_EQ(truth({255, 255, 255, 255, 255, 4, 4, 4, 4}), kNone);
  EXPECT_EQ(truth({255, 255, 255, 255, 255, 255, 255, 255, 255}), kNone);
}

TEST(TruthOfSquareTest, CountsPixelsBesideThePictureAsUnlabelled) {
  const OrthoWorld world = labelled(std::vector<std::vector<int>>(4, std::vector<int>(4, 3)));
  const Grid grid(4.0);                                    // cell (0, 0): px -2..1, py -1..2
  EXPECT_EQ(world.truthOfSquare(grid, {0, 0, 0}), kNone);  // 2 x 3 of 16
  EXPECT_EQ(world.truthOfSquare(grid, {1, 0, 0}), kNone);  // px 2, 3; py 0..2: 6 of 16
  const OrthoWorld wide = labelled(std::vector<std::vector<int>>(4, std::vector<int>(8, 3)));
  EXPECT_EQ(wide.truthOfSquare(grid, {1, 0, 0}), 3);       // px 2..5, py 0..2: 12 of 16
  EXPECT_EQ(wide.truthOfSquare(grid, {1, -1, 0}), kNone);  // py 3 alone: 4 of 16
}

// 24 x 0.1 is not 2.4 in binary, nor is any border exact; still each cell is 24 x 24 whole pixels, and no
// pixel is in two cells. By brute force over integers.
TEST(TruthOfSquareTest, GivesEveryPixelToOneCellOf24Pixels) {
  std::vector<std::vector<int>> rows(260, std::vector<int>(250, 0));
  Random random(3);
  for (auto& row : rows) {
    for (int& label : row) label = random.below(4) == 0 ? 255 : static_cast<int>(random.below(3));
  }
  for (const double metres_per_pixel : {0.1, 0.04, 1.0, 0.3, 1.0 / 3.0}) {
    const OrthoWorld world = labelled(rows, metres_per_pixel);
    const Grid grid(24 * metres_per_pixel);
    for (int j = -12; j <= 1; ++j) {
      for (int i = -1; i <= 11; ++i) {
        // X in [24 i - 12, 24 i + 12) and -py in [24 j - 12, 24 j + 12), in pixels.
        std::map<int, int> votes;
        int labelled_pixels = 0;
        for (int py = -24 * j - 11; py <= -24 * j + 12; ++py) {
          for (int px = 24 * i - 12; px < 24 * i + 12; ++px) {
            if (px < 0 || py < 0 || px >= 250 || py >= 260) continue;
            const int label = rows[static_cast<size_t>(py)][static_cast<size_t>(px)];
            if (label == 255) continue;
            ++labelled_pixels;
            ++votes[label];
          }
        }
        int expected = 255;
        if (2 * labelled_pixels >= 24 * 24) {
          expected = votes.begin()->first;
          for (const auto& [label, count] : votes) {
            if (count > votes[expected]) expected = label;
          }
        }
        ASSERT_EQ(world.truthOfSquare(grid, {i, j, 0}), expected) << metres_per_pixel << ' ' << i << ' ' << j;
      }
    }
  }
}

}  // namespace
}  // namespace shoal::world
