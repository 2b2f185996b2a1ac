// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_world.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "shoal/random.h"
#include "shoal/world/survey.h"

namespace shoal::world {
namespace {

class ReefTest : public testing::TestWithParam<const char*> {
 protected:
  // Made once for all tests of a process.
  ReefTest() {
    static std::map<std::string, ReefWorld> made;
    reef_ = &made.try_emplace(GetParam(), reefStyle(GetParam()), 4).first->second;
  }
  const ReefWorld* reef_;
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

/// Every solid whose thing stands within `reach` of a point, with its label.
struct Solid {
  Ellipsoid body;
  uint8_t label;
  float depthInside(const Eigen::Vector3f& p) const {  // 0 in the middle, 1 on the surface
    return (body.axes.inverse() * (p - body.center)).norm();
  }
};
std::vector<Solid> solidsNear(const ReefScene& scene, float x, float y, float reach) {
  std::vector<Solid> solids;
  for (int row = 0; row < ReefGarden::kBins; ++row) {
    for (const auto& thing : scene.garden().strip(0, ReefGarden::kBins - 1, row)) {
      if (std::abs(thing.x - x) > reach || std::abs(thing.y - y) > reach) continue;
      for (const Part& part : scene.garden().parts(thing))
        solids.push_back({ReefGarden::placed(part.solid, thing), thing.label});
    }
  }
  return solids;
}

// By brute force, from straight above and aslant: on the way to what a pixel shows its ray passes above the
// ground and through nothing solid, and where it ends there is the ground, or a solid of the pixel's label.
TEST_P(ReefTest, ShowsWhatItsRaysMeetFirst) {
  Random random(21);
  int on_things = 0;
  for (const double tilt : {0.0, 0.3, 0.9}) {
    for (int trial = 0; trial < 3; ++trial) {
      const double x = 20 + 210 * random.uniform(), y = -20 - 210 * random.uniform();
      Pose pose = lookingDown({x, y, 8}, 6 * random.uniform());
      pose.linear() = pose.linear() * Eigen::AngleAxisd(tilt, Eigen::Vector3d::UnitX()).toRotationMatrix();
      const Intrinsics camera{40, 30, 25, 25, 19.5, 14.5};
      const Observation seen = reef_->render(camera, pose);
      const ReefScene& scene = reef_->scene();
      for (int sample = 0; sample < 60; ++sample) {
        const int u = static_cast<int>(random.below(40)), v = static_cast<int>(random.below(30));
        const double depth = seen.depth_m.at<float>(v, u);
        const uint8_t label = seen.labels.at<uint8_t>(v, u);
        if (depth == 0.0) {
          ASSERT_EQ(label, 255);
          continue;
        }
        ASSERT_LT(label, reef_->classes().size());
        const Eigen::Vector3d ray = pose.linear() * camera.unproject(u, v, 1.0);
        if (depth * ray.norm() > 25.0) continue;  // what is small and far away may be left out
        const Eigen::Vector3f p = (pose.translation() + depth * ray).cast<float>();
        const auto solids = solidsNear(scene, p.x(), p.y(), 12.0f);
        for (double before = 0.05; before < 8.0; before *= 1.3) {
          const Eigen::Vector3f q = (pose.translation() + (depth - before) * ray).cast<float>();
          ASSERT_GT(q.z(), scene.groundHeight(q.x(), q.y()) - 2e-3f) << sample;
          for (const Solid& solid : solids) ASSERT_GT(solid.depthInside(q), 0.99f) << sample << ' ' << before;
        }
        bool found = std::abs(p.z() - scene.groundHeight(p.x(), p.y())) < 2e-3f;
        for (const Solid& solid : solids) {
          if (solid.label != label || std::abs(solid.depthInside(p) - 1.0f) > 0.02f) continue;
          found = true;
          ++on_things;
          break;
        }
        ASSERT_TRUE(found) << u << ' ' << v << ' ' << tilt;
      }
    }
  }
  EXPECT_GT(on_things, 10);
}

TEST_P(ReefTest, SeesGroundOrThingsInEveryPixelThatLooksDownInside) {
  const Observation seen = reef_->render({}, lookingDown({125, -125, 8}));
  EXPECT_EQ(cv::countNonZero(seen.depth_m), 320 * 240);
  EXPECT_EQ(cv::countNonZero(seen.labels == 255), 0);
}

// A map of 40 x 40 m: there is relief, there are steep sides, and all within bounds.
TEST_P(ReefTest, HasReliefAndSteepSides) {
  double lowest = 9, highest = -9;
  int steep = 0;
  for (const auto& [x, y] : {std::pair{10., -60.}, {180., -60.}, {10., -230.}, {180., -230.}}) {
    const Observation map = reef_->fromAbove({x, y, x + 40, y + 40}, 0.1);
    double low, high;
    cv::minMaxLoc(map.depth_m, &low, &high);
    lowest = std::min(lowest, low);
    highest = std::max(highest, high);
    for (int v = 0; v < map.depth_m.rows; ++v) {
      for (int u = 1; u < map.depth_m.cols; ++u)
        steep += std::abs(map.depth_m.at<float>(v, u) - map.depth_m.at<float>(v, u - 1)) > 0.2f;
    }
  }
  EXPECT_GE(lowest, ReefScene::kLowest);
  EXPECT_LE(highest, ReefScene::kHighest);
  EXPECT_LT(lowest, -0.2);
  EXPECT_GT(highest, 1.2);
  EXPECT_GT(steep, 1000);  // of 640,000 pairs of neighbours: more than 60 degrees
}

// A lens sees the side of what stands aside: what a frame shows of a place depends on where it is taken from.
TEST_P(ReefTest, HidesWhatStandsBehind) {
  int hidden = 0, compared = 0;
  const Intrinsics camera;
  for (const auto& [x, y] : {std::pair{60., -60.}, {190., -60.}, {60., -190.}, {190., -190.}}) {
    const Observation above = reef_->fromAbove({x - 6, y - 5, x + 6, y + 5}, 0.04);
    const Observation seen = reef_->render(camera, lookingDown({x, y, 8}));
    for (int v = 0; v < 240; v += 3) {
      for (int u = 0; u < 320; u += 3) {
        const Eigen::Vector3d p =
            seen.world_from_camera * camera.unproject(u, v, seen.depth_m.at<float>(v, u));
        const int column = static_cast<int>((p.x() - x + 6) / 0.04),
                  row = static_cast<int>((y + 5 - p.y()) / 0.04);
        if (column < 0 || row < 0 || column >= above.labels.cols || row >= above.labels.rows) continue;
        ++compared;
        // What it sees lies under what is seen from straight above: it looks beneath an overhang.
        hidden += p.z() < above.depth_m.at<float>(row, column) - 0.1;
        ASSERT_LT(p.z(), above.depth_m.at<float>(row, column) + 3.0);
      }
    }
  }
  EXPECT_GT(compared, 20000);
  EXPECT_GT(hidden, 20);
}

TEST_P(ReefTest, EndsAtItsBorder) {
  const Observation seen = reef_->render({}, lookingDown({0, 0, 8}));  // the north-west corner in the middle
  for (int v : {5, 60, 235}) {
    for (int u : {5, 80, 315}) {
      const bool inside = u > 160 && v > 120;
      EXPECT_EQ(seen.depth_m.at<float>(v, u) > 0, inside) << u << ' ' << v;
      EXPECT_EQ(seen.labels.at<uint8_t>(v, u) < 255, inside);
      if (!inside) {
        EXPECT_EQ(seen.color.at<cv::Vec3b>(v, u), cv::Vec3b(0, 0, 0));
      }
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
  EXPECT_EQ(cv::norm(a.labels, moved.labels, cv::NORM_INF), 0);
  // Two draws of triangular grain on +- 4 to 10 grey levels lie some 2 to 5 apart in the mean; the waves have
  // moved as well.
  const double apart = cv::norm(a.color, moved.color, cv::NORM_L1) / (3 * 320 * 240);
  EXPECT_GT(apart, 2.0);
  EXPECT_LT(apart, 15.0);
}

TEST_P(ReefTest, IsAnotherPlaceWithAnotherSeed) {
  const ReefWorld other(reefStyle(GetParam()), 5);
  int differ = 0;
  for (int i = 0; i < 25; ++i) {
    for (int j = 0; j < 25; ++j) {
      const float x = 5.0f + 10.0f * static_cast<float>(i), y = -5.0f - 10.0f * static_cast<float>(j);
      differ += std::abs(reef_->scene().groundHeight(x, y) - other.scene().groundHeight(x, y)) > 0.01f;
    }
  }
  EXPECT_GT(differ, 500);
}

/// Shares of the classes in a part of a reef, edges multiples of 10 m, seen from straight above.
std::vector<double> shares(const ReefWorld& reef, const Extent& part) {
  std::vector<double> share(reef.classes().size());
  double points = 0;
  for (double x = part.min_x; x < part.max_x; x += 10) {
    for (double y = part.min_y; y < part.max_y; y += 10) {
      const cv::Mat labels = reef.fromAbove({x, y, x + 10, y + 10}, 0.2).labels;
      for (const uint8_t label : cv::Mat_<uint8_t>(labels)) ++share[label];
      points += static_cast<double>(labels.total());
    }
  }
  for (double& s : share) s /= points;
  return share;
}

TEST_P(ReefTest, HasEnoughOfEveryClass) {
  for (const double share : shares(*reef_, reef_->extent())) EXPECT_GT(share, 0.015);
}

TEST_P(ReefTest, RefusesMapsThatAreTooLargeOrOutside) {
  EXPECT_THROW(reef_->fromAbove({0, -51, 10, 0}, 0.1), std::invalid_argument);
  EXPECT_THROW(reef_->fromAbove({245, -10, 251, 0}, 0.1), std::invalid_argument);
  EXPECT_THROW(reef_->fromAbove({10, -10, 5, 0}, 0.1), std::invalid_argument);
  EXPECT_THROW(reef_->fromAbove({0, -10, 10, 0}, 0.0), std::invalid_argument);
}

TEST(ReefSparseTest, IsMostlySandInLightAndShade) {
  const ReefWorld reef(reefStyle("reef:sparse"), 1);
  const double sand = shares(reef, reef.extent())[0];
  EXPECT_GT(sand, 0.5);
  EXPECT_LT(sand, 0.8);
  // Brightness of bare sand: a dark and a bright tenth, well apart.
  std::vector<uint8_t> green;
  for (double x = 0; x < 250; x += 25) {
    for (double y = -250; y < 0; y += 25) {
      const Observation map = reef.fromAbove({x, y, x + 25, y + 25}, 0.5);
      for (int v = 0; v < map.labels.rows; ++v) {
        for (int u = 0; u < map.labels.cols; ++u)
          if (map.labels.at<uint8_t>(v, u) == 0) green.push_back(map.color.at<cv::Vec3b>(v, u)[1]);
      }
    }
  }
  std::sort(green.begin(), green.end());
  EXPECT_GT(green[green.size() * 9 / 10], 1.4 * green[green.size() / 10]);
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

// Cells whose truth a flat map of their square gives, and by projection of the frames above them, as missions
// do.
TEST_P(ReefTest, HasTheSameTruthInFramesAsInMapsWhereItIsFlat) {
  int agree = 0, cells = 0;
  for (const auto& [x, y] : {std::pair{60.8, -60.8}, {188.8, -60.8}, {60.8, -188.8}, {188.8, -188.8}}) {
    const Observation seen = reef_->render({}, lookingDown({x, y, 8}));
    const Grid grid(0.8);
    std::map<std::pair<int, int>, std::vector<int>> votes;
    for (int v = 0; v < 240; ++v) {
      for (int u = 0; u < 320; ++u) {
        const Eigen::Vector3d p =
            seen.world_from_camera * seen.intrinsics.unproject(u, v, seen.depth_m.at<float>(v, u));
        const CellIndex cell = grid.cellOf(p);
        auto& vote = votes[{cell.x, cell.y}];
        vote.resize(9);
        ++vote[seen.labels.at<uint8_t>(v, u)];
      }
    }
    for (const auto& [cell, vote] : votes) {
      const Eigen::Vector3d middle = grid.centerOf({cell.first, cell.second, 0});
      if (std::abs(middle.x() - x) > 3 || std::abs(middle.y() - y) > 3) continue;
      const cv::Mat labels =
          reef_->fromAbove({middle.x() - .4, middle.y() - .4, middle.x() + .4, middle.y() + .4}, 0.04).labels;
      std::vector<int> above(9);
      for (const uint8_t label : cv::Mat_<uint8_t>(labels)) ++above[label];
      ++cells;
      agree += std::max_element(above.begin(), above.end()) - above.begin() ==
               std::max_element(vote.begin(), vote.end()) - vote.begin();
    }
  }
  EXPECT_GT(cells, 150);
  EXPECT_GT(agree, cells * 9 / 10);  // sides of things, and what they hide, make the rest
}

}  // namespace
}  // namespace shoal::world
