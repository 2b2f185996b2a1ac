// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

namespace shoal::world {

/// A folder of the running test, empty at first and gone afterwards.
class WorldOnDisk {
 public:
  WorldOnDisk() {
    const auto* test = ::testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("shoal_") + test->test_suite_name() + "_" + test->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~WorldOnDisk() { std::filesystem::remove_all(folder_); }
  WorldOnDisk(const WorldOnDisk&) = delete;
  WorldOnDisk& operator=(const WorldOnDisk&) = delete;

  const std::filesystem::path& folder() const { return folder_; }

  void write(const std::string& file, const std::string& text) const {
    std::ofstream(folder_ / file) << text;
  }
  void write(const std::string& file, const cv::Mat& picture) const {
    ASSERT_TRUE(cv::imwrite((folder_ / file).string(), picture));
  }

  /// A good world of 6 x 4 pixels with classes 0 and 3; returns its world.json.
  nlohmann::json writeGoodWorld() const {
    cv::Mat color(4, 6, CV_8UC3, cv::Scalar(10, 20, 30)), labels(4, 6, CV_8UC1, cv::Scalar(3));
    color.at<cv::Vec3b>(1, 2) = {1, 2, 3};
    labels.at<uint8_t>(0, 0) = 255;
    labels.at<uint8_t>(1, 2) = 0;
    write("world.png", color);
    write("labels.png", labels);
    nlohmann::json world = {{"name", "tiny"},
                            {"metres_per_pixel", 0.5},
                            {"size_px", {6, 4}},
                            {"image", "world.png"},
                            {"labels", "labels.png"},
                            {"unlabelled", 255},
                            {"licence", "unknown keys are fine"},
                            {"classes",
                             {{{"id", 0}, {"name", "sand"}, {"rgb", {1, 2, 3}}, {"share", 0.5}},
                              {{"id", 3}, {"name", "rock"}, {"rgb", {4, 5, 6}}}}}};
    write("world.json", world.dump());
    return world;
  }

 private:
  std::filesystem::path folder_;
};

/// What `action` complains about, "" when it does not.
template <class Action>
std::string complaint(Action action) {
  try {
    action();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

}  // namespace shoal::world
