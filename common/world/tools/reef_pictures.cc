// SPDX-License-Identifier: BSD-3-Clause
// Pictures of the procedural reefs: a map of each with its truth beside it, and what cameras see.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "shoal/random.h"
#include "shoal/world/reef_world.h"

namespace {

namespace fs = std::filesystem;
using shoal::world::Observation;
using shoal::world::ReefWorld;

struct Map {
  cv::Mat color, labels;
};

// Patch by patch, 25 m a side.
Map mapOf(const ReefWorld& reef, double metres_per_pixel) {
  constexpr double kPatch = 25.0;
  const int side = static_cast<int>(std::lround(kPatch / metres_per_pixel));
  Map map{cv::Mat(10 * side, 10 * side, CV_8UC3), cv::Mat(10 * side, 10 * side, CV_8UC1)};
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) {
      const Observation patch =
          reef.fromAbove({x * kPatch, -(y + 1) * kPatch, (x + 1) * kPatch, -y * kPatch}, metres_per_pixel);
      const cv::Rect place(x * side, y * side, side, side);
      patch.color.copyTo(map.color(place));
      patch.labels.copyTo(map.labels(place));
    }
  }
  return map;
}

cv::Mat paintLabels(const ReefWorld& reef, const cv::Mat& labels) {
  cv::Mat table(1, 256, CV_8UC3, cv::Scalar::all(0));
  for (const auto& c : reef.classes()) {
    table.at<cv::Vec3b>(c.id) = {c.rgb[2], c.rgb[1], c.rgb[0]};
  }
  cv::Mat three, painted;
  cv::cvtColor(labels, three, cv::COLOR_GRAY2BGR);
  cv::LUT(three, table, painted);
  return painted;
}

// Names of the classes beside their colours, as wide as the picture.
cv::Mat legendOf(const ReefWorld& reef, int width) {
  cv::Mat legend(22, width, CV_8UC3, cv::Scalar::all(255));
  int x = 6;
  for (const auto& c : reef.classes()) {
    cv::rectangle(legend, {x, 5, 12, 12}, cv::Scalar(c.rgb[2], c.rgb[1], c.rgb[0]), cv::FILLED);
    cv::putText(legend, c.name, {x + 16, 15}, cv::FONT_HERSHEY_SIMPLEX, 0.4, cv::Scalar::all(0), 1,
                cv::LINE_AA);
    x += 28 + cv::getTextSize(c.name, cv::FONT_HERSHEY_SIMPLEX, 0.4, 1, nullptr).width;
  }
  return legend;
}

void write(const fs::path& file, const cv::Mat& picture, int quality) {
  if (!cv::imwrite(file.string(), picture, {cv::IMWRITE_JPEG_QUALITY, quality}))
    throw std::runtime_error("cannot write " + file.string());
}

// Where every quarter of a reef is seen twice, from the usual altitude and aslant from lower.
cv::Mat framesOf(const ReefWorld& reef) {
  constexpr double kPlaces[4][2] = {{58, -52}, {190, -66}, {66, -186}, {196, -194}};
  const shoal::world::Intrinsics camera;
  std::vector<cv::Mat> columns;
  for (const auto& [x, y] : kPlaces) {
    const Observation down = reef.render(camera, shoal::world::lookingDown({x, y, 8}, 0.3));
    shoal::world::Pose aslant = shoal::world::lookingDown({x, y - 4, 5}, 0.3);
    aslant.linear() = aslant.linear() * Eigen::AngleAxisd(0.75, Eigen::Vector3d::UnitX()).toRotationMatrix();
    cv::Mat column;
    cv::vconcat(
        std::vector<cv::Mat>{down.color, paintLabels(reef, down.labels), reef.render(camera, aslant).color},
        column);
    columns.push_back(column);
  }
  cv::Mat all;
  cv::hconcat(columns, all);
  return all;
}

void picture(const std::string& name, uint64_t seed, const fs::path& folder) {
  const ReefWorld reef(shoal::world::reefStyle("reef:" + name), seed);
  const Map map = mapOf(reef, 0.125);
  cv::Mat small_map, truth = paintLabels(reef, map.labels), small_truth, pair;
  cv::resize(map.color, small_map, {640, 640}, 0, 0, cv::INTER_AREA);
  cv::resize(truth, small_truth, {640, 640}, 0, 0, cv::INTER_NEAREST);
  cv::hconcat(small_map, small_truth, pair);
  cv::vconcat(pair, legendOf(reef, pair.cols), pair);
  write(folder / ("reef_" + name + "_map.jpg"), pair, 85);
  write(folder / ("reef_" + name + "_frames.jpg"), framesOf(reef), 88);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2 || std::string(argv[1]).starts_with("-")) {
    std::cerr << "usage: shoal_reef_pictures FOLDER\n"
                 "Writes reef_sparse_map.jpg, reef_sparse_frames.jpg and likewise of reef:varied and "
                 "reef:tuning.\n";
    return 2;
  }
  try {
    for (const std::string name : {"sparse", "varied", "tuning"}) picture(name, 1, argv[1]);
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
