// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/cell_truth.h"

#include <gtest/gtest.h>

namespace shoal::eval {
namespace {

// A camera 1 m above the ground that looks straight down; with fx = 1 a pixel covers 1 m x 1 m, and pixel
// (u, v) lands at X = u, Y = -v.
world::Observation frame(const cv::Mat_<uint8_t>& labels, float depth = 1.f) {
  world::Observation o;
  o.intrinsics = {labels.cols, labels.rows, 1.0, 1.0, 0.0, 0.0};
  o.world_from_camera = world::lookingDown({0, 0, 1});
  o.labels = labels;
  o.depth_m = cv::Mat(labels.size(), CV_32FC1, cv::Scalar(depth));
  return o;
}

TEST(ProjectedTruthTest, CountsPixelsWhereTheyFall) {
  // Cells of 2 m centred at even metres: pixels 0 fall in cell 0 (-1..1), pixels 1 and 2 in cell 1 (1..3).
  ProjectedTruth truth{world::Grid(2.0)};
  truth.add(frame((cv::Mat_<uint8_t>(1, 3) << 4, 7, 7)));
  EXPECT_EQ(truth.at({0, 0, 0}), 4);
  EXPECT_EQ(truth.at({1, 0, 0}), 7);
  EXPECT_EQ(truth.at({2, 0, 0}), std::nullopt);
}

TEST(ProjectedTruthTest, TiesGoToTheLowestClassAndFramesAddUp) {
  ProjectedTruth truth{world::Grid(100.0)};
  truth.add(frame((cv::Mat_<uint8_t>(1, 2) << 5, 3)));
  EXPECT_EQ(truth.at({0, 0, 0}), 3);
  truth.add(frame((cv::Mat_<uint8_t>(1, 1) << 5)));
  EXPECT_EQ(truth.at({0, 0, 0}), 5);
}

TEST(ProjectedTruthTest, HalfOfThePixelsMustBeLabelled) {
  ProjectedTruth truth{world::Grid(100.0)};
  truth.add(frame((cv::Mat_<uint8_t>(1, 4) << 1, 1, 255, 255)));
  EXPECT_EQ(truth.at({0, 0, 0}), 1);
  truth.add(frame((cv::Mat_<uint8_t>(1, 1) << 255)));
  EXPECT_EQ(truth.at({0, 0, 0}), std::nullopt);
}

TEST(ProjectedTruthTest, PixelsWithoutDepthDoNotVote) {
  ProjectedTruth truth{world::Grid(100.0)};
  truth.add(frame((cv::Mat_<uint8_t>(1, 1) << 1), 0.f));
  truth.add(frame((cv::Mat_<uint8_t>(1, 1) << 1), NAN));
  EXPECT_EQ(truth.at({0, 0, 0}), std::nullopt);
}

TEST(ProjectedTruthTest, AnyIdBut255IsAClass) {
  ProjectedTruth truth{world::Grid(100.0)};
  truth.add(frame((cv::Mat_<uint8_t>(1, 4) << 254, 254, 40, 255)));
  EXPECT_EQ(truth.at({0, 0, 0}), 254);
}

TEST(ProjectedTruthTest, WhatIsTooFarForACellIsLeftOut) {
  ProjectedTruth truth{world::Grid(1e-3)};
  truth.add(frame((cv::Mat_<uint8_t>(1, 1) << 1), 3e9f));
  EXPECT_EQ(truth.at({0, 0, INT32_MIN}), std::nullopt);
}

TEST(ProjectedTruthTest, HalvesCountedApartGiveTheWhole) {
  ProjectedTruth a{world::Grid(100.0)}, b{world::Grid(100.0)};
  a.add(frame((cv::Mat_<uint8_t>(1, 3) << 2, 2, 9)));
  b.add(frame((cv::Mat_<uint8_t>(1, 2) << 9, 9)));
  a.add(b);
  EXPECT_EQ(a.at({0, 0, 0}), 9);
}

}  // namespace
}  // namespace shoal::eval
