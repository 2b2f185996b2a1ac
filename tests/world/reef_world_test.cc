// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_world.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "shoal/random.h"
#include "shoal/world/survey.h"

namespace shoal::world {
namespace {

class ReefTest : public testing::TestWithParam<const char*> {
 protected:
  ReefTest() : reef_(std::make_unique<ReefWorld>(reefStyle(GetParam()), 4)) {}
  std::unique_ptr<ReefWorld> reef_;
};

INSTANTIATE_TEST_SUITE_P(Every, ReefTest, testing::Values("reef:sparse", "reef:varied", "reef:tuning"),
                         [](const auto& reef) { return std::string(reef.param).substr(5); });

TEST_P(ReefTest, IsASquareOf250MetresSeenFromEightMetres) {
  EXPECT_EQ(reef_->name(), GetParam());
  const Extent extent = reef_->extent();
  EXPECT_EQ(extent.min_x, 0);
  EXPECT_EQ(extent.max_x, 250);
  EXPECT_EQ(extent.min_y, -250);
  EXPECT_EQ(extent.max_y, 0);
  EXPECT_EQ(reef_->metresPerPixel(), 0.04);
  EXPECT_EQ(reef_->defaultCellSize(), 0.8);
  EXPECT_FALSE(reef_->hasFlatTruth());
  EXPECT_EQ(reef_->truthOfSquare(Grid(0.8), {3, -3, 0}), std::nullopt);
  EXPECT_DOUBLE_EQ(surveyPath(*reef_, {}, 0).front().translation().z(), 8.0);
}

TEST_P(ReefTest, NumbersItsClassesFromZero) {
  const auto& classes = reef_->classes();
  EXPECT_GE(classes.size(), 5u);
  EXPECT_LE(classes.size(), 8u);
  for (size_t i = 0; i < classes.size(); ++i)
    EXPECT_EQ(classes[i].id, static_cast<int>(i)) << classes[i].name;
}

// Every pixel lies on the surface, and its label is what the surface says: from straight above, turned, and
// tilted so far that bumps hide others.
TEST_P(ReefTest, ShowsWhatLiesWhereItsDepthPuts) {
  Random random(21);
  for (const double tilt : {0.0, 0.3, 1.2}) {
    for (int trial = 0; trial < 4; ++trial) {
      Pose pose =
          lookingDown({20 + 210 * random.uniform(), -20 - 210 * random.uniform(), 8}, 6 * random.uniform());
      pose.linear() = pose.linear() * Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
      const Intrinsics camera{80, 60, 50, 50, 39.5, 29.5};
      const Observation seen = reef_->render(camera, pose);
      int with_depth = 0;
      for (int v = 0; v < camera.height; ++v) {
        for (int u = 0; u < camera.width; ++u) {
          const double depth = seen.depth_m.at<float>(v, u);
          if (depth == 0.0) {
            ASSERT_EQ(seen.labels.at<uint8_t>(v, u), 255);
            ASSERT_EQ(seen.color.at<cv::Vec3b>(v, u), cv::Vec3b(0, 0, 0));
            continue;
          }
          ++with_depth;
          const Eigen::Vector3d p = pose * camera.unproject(u, v, depth);
          const float x = static_cast<float>(p.x()), y = static_cast<float>(p.y());
          // Half a millimetre of the search, and single precision of far depths on slopes.
          ASSERT_NEAR(p.z(), reef_->surface().heightAt(x, y), 1e-3 + 1e-6 * depth);
          const uint8_t label = seen.labels.at<uint8_t>(v, u);
          ASSERT_LT(label, reef_->classes().size());
          // Rounding of the depth may cross a border between classes.
          bool found = false;
          for (const float dx : {0.0f, -0.002f, 0.002f}) {
            for (const float dy : {0.0f, -0.002f, 0.002f})
              found |= reef_->surface().at(x + dx, y + dy).label == label;
          }
          ASSERT_TRUE(found) << u << ' ' << v << ' ' << tilt;
        }
      }
      if (tilt < 1.0) {
        ASSERT_EQ(with_depth, camera.width * camera.height);
      }
    }
  }
}

TEST_P(ReefTest, KeepsItsHeightsAndSlopes) {
  Random random(22);
  float lowest = 9, highest = -9, steepest = 0;
  for (int i = 0; i < 100000; ++i) {
    const float x = static_cast<float>(250 * random.uniform()),
                y = static_cast<float>(-250 * random.uniform());
    const float h = reef_->surface().heightAt(x, y);
    lowest = std::min(lowest, h);
    highest = std::max(highest, h);
    constexpr float kStep = 0.02f;
    steepest = std::max({steepest, std::abs(reef_->surface().heightAt(x + kStep, y) - h) / kStep,
                         std::abs(reef_->surface().heightAt(x, y + kStep) - h) / kStep});
  }
  EXPECT_GT(lowest, ReefSurface::kMinHeight);
  EXPECT_LT(highest, ReefSurface::kMaxHeight);
  EXPECT_LT(lowest, -0.4f);  // there is relief
  EXPECT_GT(highest, 0.8f);
  EXPECT_LT(steepest, 0.84f);  // 40 degrees
}

TEST_P(ReefTest, EndsAtItsBorder) {
  const Observation seen = reef_->render({}, lookingDown({0, 0, 8}));  // the north-west corner in the middle
  for (int v : {5, 60, 235}) {
    for (int u : {5, 80, 315}) {
      const bool inside = u > 160 && v > 120;
      EXPECT_EQ(seen.depth_m.at<float>(v, u) > 0, inside) << u << ' ' << v;
    }
  }
}

TEST_P(ReefTest, ShowsNothingToACameraThatLooksUpOrLiesInTheGround) {
  Pose up = Pose::Identity();
  up.translation() = Eigen::Vector3d(100, -100, 8);
  EXPECT_EQ(cv::countNonZero(reef_->render({32, 24}, up).depth_m), 0);
  EXPECT_EQ(cv::countNonZero(reef_->render({32, 24}, lookingDown({100, -100, -5})).depth_m), 0);
}

TEST_P(ReefTest, ShowsTheSameFromTheSamePoseAndOtherGrainFromAnother) {
  const Pose pose = lookingDown({120, -90, 8});
  const Observation a = reef_->render({}, pose), b = ReefWorld(reefStyle(GetParam()), 4).render({}, pose);
  EXPECT_EQ(cv::norm(a.color, b.color, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(a.labels, b.labels, cv::NORM_INF), 0);
  EXPECT_EQ(cv::norm(a.depth_m, b.depth_m, cv::NORM_INF), 0);
  const Observation moved = reef_->render({}, lookingDown({120 + 1e-7, -90, 8}));
  // Two draws of triangular grain on [-7, 7] lie some 3.3 grey levels apart in the mean.
  EXPECT_NEAR(cv::norm(a.color, moved.color, cv::NORM_L1) / (3 * 320 * 240), 3.3, 0.4);
}

TEST_P(ReefTest, IsAnotherPlaceWithAnotherSeed) {
  const ReefWorld other(reefStyle(GetParam()), 5);
  int differ = 0;
  for (int i = 0; i < 25; ++i) {
    for (int j = 0; j < 25; ++j) {
      const float x = 5.0f + 10.0f * static_cast<float>(i), y = -5.0f - 10.0f * static_cast<float>(j);
      differ += std::abs(reef_->surface().heightAt(x, y) - other.surface().heightAt(x, y)) > 0.01f;
    }
  }
  EXPECT_GT(differ, 500);
}

/// Shares of the classes in a part of a reef, by points 1 m apart.
std::vector<double> shares(const ReefWorld& reef, const Extent& part) {
  std::vector<double> share(reef.classes().size());
  double points = 0;
  for (double x = part.min_x + 0.5; x < part.max_x; ++x) {
    for (double y = part.min_y + 0.5; y < part.max_y; ++y) {
      ++share[reef.surface().at(static_cast<float>(x), static_cast<float>(y)).label];
      ++points;
    }
  }
  for (double& s : share) s /= points;
  return share;
}

TEST_P(ReefTest, HasEnoughOfEveryClass) {
  for (const double share : shares(*reef_, reef_->extent())) EXPECT_GT(share, 0.015);
}

TEST(ReefSparseTest, IsMostlySandInLightAndShade) {
  const ReefWorld reef(reefStyle("reef:sparse"), 1);
  const double sand = shares(reef, reef.extent())[0];
  EXPECT_GT(sand, 0.5);
  EXPECT_LT(sand, 0.8);
  // Brightness of bare sand: a dark and a bright tenth, well apart.
  std::vector<float> green;
  for (float x = 0.5f; x < 250; x += 2) {
    for (float y = -249.5f; y < 0; y += 2) {
      const SeabedPoint p = reef.surface().at(x, y);
      if (p.label == 0) green.push_back(p.color[1]);
    }
  }
  std::sort(green.begin(), green.end());
  EXPECT_GT(green[green.size() * 9 / 10], 1.5f * green[green.size() / 10]);
}

// Half the sum of differences of shares: 0 for alike, 1 for nothing in common.
TEST(ReefVariedTest, HasLittleInCommonBetweenItsQuarters) {
  const ReefWorld reef(reefStyle("reef:varied"), 1);
  const Extent quarters[] = {
      {0, -110, 110, 0}, {140, -110, 250, 0}, {0, -250, 110, -140}, {140, -250, 250, -140}};
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < a; ++b) {
      const std::vector<double> in_a = shares(reef, quarters[a]), in_b = shares(reef, quarters[b]);
      double apart = 0;
      for (size_t i = 0; i < in_a.size(); ++i) apart += 0.5 * std::abs(in_a[i] - in_b[i]);
      EXPECT_GT(apart, 0.4) << a << ' ' << b;
    }
  }
}

}  // namespace
}  // namespace shoal::world
