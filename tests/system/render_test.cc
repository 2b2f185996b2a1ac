// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/render.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>
#include <Eigen/Core>
#include <opencv2/core.hpp>

namespace shoal::console {
namespace {

using world::GlobalLabel;

mapping::GlobalCell cell(int x, int y, int z, int label) {
  return {{x, y, z}, GlobalLabel{label}, world::RobotId{0}, {0}, 1.f};
}

bool has(const cv::Mat& picture, const Rgb& color) {
  for (int v = 0; v < picture.rows; ++v)
    for (int u = 0; u < picture.cols; ++u)
      if (picture.at<cv::Vec3b>(v, u) == cv::Vec3b(color[2], color[1], color[0])) return true;
  return false;
}

TEST(ColorOfTest, IsTheLabelsOwn) {
  EXPECT_EQ(colorOf(GlobalLabel{30007}), colorOf(GlobalLabel{30007}));
  EXPECT_NE(colorOf(GlobalLabel{30007}), colorOf(GlobalLabel{30008}));
}

// CIE L*a*b* under D65 of linear light in sRGB's primaries.
Eigen::Vector3d labOf(const Eigen::Vector3d& light) {
  Eigen::Matrix3d xyz_from_rgb;
  xyz_from_rgb << .4124564, .3575761, .1804375, .2126729, .7151522, .0721750, .0193339, .1191920, .9503041;
  const Eigen::Vector3d xyz =
      (xyz_from_rgb * light.cwiseMax(0).cwiseMin(1)).cwiseQuotient(Eigen::Vector3d(.95047, 1, 1.08883));
  const Eigen::Vector3d f =
      xyz.unaryExpr([](double t) { return t > .008856 ? std::cbrt(t) : 7.787 * t + 16. / 116; });
  return {116 * f.y() - 16, 500 * (f.x() - f.y()), 200 * (f.y() - f.z())};
}

Eigen::Vector3d lightOf(const Rgb& color) {
  Eigen::Vector3d light;
  for (int i = 0; i < 3; ++i) {
    const double c = color[static_cast<size_t>(i)] / 255.;
    light[i] = c <= .04045 ? c / 12.92 : std::pow((c + .055) / 1.055, 2.4);
  }
  return light;
}

// Dichromats' sight, after Machado et al. 2009, table 1. Nine is told apart at a glance, two just so side by
// side.
TEST(ColorOfTest, NoEyeTakesATopicOfARobotForAnother) {
  Eigen::Matrix3d protan, deutan;
  protan << .152286, 1.052583, -.204868, .114503, .786281, .099216, -.003882, -.048116, 1.051998;
  deutan << .367322, .860646, -.227968, .280085, .672501, .047413, -.011820, .042940, .968881;
  for (const Eigen::Matrix3d& eye : {Eigen::Matrix3d(Eigen::Matrix3d::Identity()), protan, deutan})
    for (int robot : {0, 3, 11})
      for (int a = 0; a < 36; ++a)
        for (int b = 0; b < a; ++b) {
          const auto seen = [&](int topic) {
            return labOf(eye * lightOf(colorOf(GlobalLabel{robot * 10000 + topic})));
          };
          EXPECT_GT((seen(a) - seen(b)).norm(), 9) << robot << ": " << a << ", " << b;
        }
}

TEST(RenderTest, NorthIsUpAndTheHighestCellShows) {
  mapping::GlobalMap map;
  map.cells = {cell(0, 0, 0, 1), cell(0, 1, 0, 2), cell(0, 1, 1, 3)};
  map.labels = {
      {GlobalLabel{1}, "", 1, {}, {0}}, {GlobalLabel{2}, "", 1, {}, {0}}, {GlobalLabel{3}, "", 1, {}, {0}}};
  const cv::Mat picture = render(map, world::Grid(1.0), "title");
  // Two square cells above one another, 720 pixels high in all, below the title.
  const auto at = [&](int row) { return picture.at<cv::Vec3b>(50 + row, 16 + 100); };
  const Rgb top = colorOf(GlobalLabel{3}), bottom = colorOf(GlobalLabel{1});
  EXPECT_EQ(at(100), cv::Vec3b(top[2], top[1], top[0]));
  EXPECT_EQ(at(600), cv::Vec3b(bottom[2], bottom[1], bottom[0]));
}

TEST(RenderTest, BesideATruthLabelsTakeTheColourOfTheirClass) {
  mapping::GlobalMap map;
  for (int i = 0; i < 4; ++i) map.cells.push_back(cell(i, 0, 0, i < 3 ? 5 : 6));
  map.labels = {{GlobalLabel{5}, "", 3, {}, {0}}, {GlobalLabel{6}, "", 1, {}, {0}}};
  const TruthPicture truth{{{0, "sand", {1, 2, 3}}, {1, "rock", {9, 8, 7}}},
                           [](const world::CellIndex& c) { return std::optional<int>(c.x < 3 ? 1 : 0); }};
  const auto colors = alignedColors(map, truth);
  EXPECT_EQ(colors.at(GlobalLabel{5}), (Rgb{9, 8, 7}));
  EXPECT_EQ(colors.at(GlobalLabel{6}), (Rgb{1, 2, 3}));
  EXPECT_TRUE(has(render(map, world::Grid(1.0), "t", truth), {9, 8, 7}));
}

TEST(RenderTest, TheLegendIsAsHighAsTheMapOrNamesEight) {
  mapping::GlobalMap map;
  LegendPictures pictures;
  for (int i = 0; i < 40; ++i) {
    map.cells.push_back(cell(i % 10, i / 10, 0, i));
    map.labels.push_back({GlobalLabel{i}, "", 1, {}, {0}});
    pictures[GlobalLabel{i}] = cv::Mat(32, 32, CV_8UC3, cv::Scalar(i, 1, 2));
  }
  const auto shows = [&](const cv::Mat& picture, int i) {
    return has(picture, {2, 1, static_cast<uint8_t>(i)});
  };
  const cv::Mat flat = render(map, world::Grid(1.0), "t", {}, pictures);  // 720 x 288 pixels of map
  EXPECT_TRUE(shows(flat, 6));
  EXPECT_FALSE(shows(flat, 7));  // there stands how many more there are
  for (auto& c : map.cells) std::swap(c.cell.x, c.cell.y);
  const cv::Mat high = render(map, world::Grid(1.0), "t", {}, pictures);  // 288 x 720
  EXPECT_EQ(high.rows, 34 + 720 + 2 * 16);
  EXPECT_TRUE(shows(high, 16));
  EXPECT_FALSE(shows(high, 20));
}

TEST(RenderTest, NoNameIsCutAtThePicturesEdge) {
  mapping::GlobalMap map;
  for (int i = 0; i < 4; ++i) map.cells.push_back(cell(i, 0, 0, 5));
  map.labels = {{GlobalLabel{5}, "", 4, {}, {0}}};
  const auto named = [&](const std::string& name) {
    map.labels[0].name = name;
    return render(map, world::Grid(1.0), "t");
  };
  const cv::Mat plain = named("");
  for (const std::string& name : {std::string("bed of large mussels"), std::string(64, 'W')}) {
    const cv::Mat picture = named(name);
    EXPECT_GT(picture.cols, plain.cols) << name;
    EXPECT_LT(picture.cols, plain.cols + 200) << name;
    const cv::Mat edge = picture.colRange(picture.cols - 10, picture.cols);
    EXPECT_EQ(cv::norm(edge, cv::Mat(edge.size(), edge.type(), cv::Scalar::all(250))), 0) << name;  // paper
  }
  EXPECT_EQ(encodePng(named("Gr\u00fc\u00dfe")), encodePng(plain));  // it goes by its number
}

TEST(RenderTest, AnEmptyMapSaysSo) {
  const cv::Mat picture = render({}, world::Grid(1.0), "title");
  EXPECT_FALSE(picture.empty());
  EXPECT_EQ(encodePng(picture).substr(1, 3), "PNG");
}

}  // namespace
}  // namespace shoal::console
