// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/tools/training_pictures.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "shoal/random.h"
#include "shoal/world/world.h"

namespace shoal::vision {
namespace {

constexpr uint64_t kReefSeed = 20210530;

}  // namespace

std::vector<std::filesystem::path> picturesIn(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    const std::string kind = entry.path().extension().string();
    if (entry.is_regular_file() && (kind == ".jpg" || kind == ".jpeg" || kind == ".png"))
      files.push_back(entry);
  }
  std::sort(files.begin(), files.end());
  return files;
}

cv::Mat loadPicture(const std::filesystem::path& file, int longest_side) {
  cv::Mat picture = cv::imread(file.string(), cv::IMREAD_COLOR);
  if (picture.empty()) throw std::runtime_error(file.string() + " is not a picture that can be read");
  const double shrink = static_cast<double>(longest_side) / std::max(picture.cols, picture.rows);
  if (shrink < 1.0) cv::resize(picture, picture, {}, shrink, shrink, cv::INTER_AREA);
  return picture;
}

std::vector<cv::Mat> reefFrames(const std::string& spec, int num_frames) {
  const auto reef = world::openWorld(spec, kReefSeed);
  const world::Intrinsics camera;
  const world::Extent extent = reef->extent();
  const double altitude_m = camera.fx * reef->metresPerPixel();
  const double margin_m = std::hypot(camera.width, camera.height) / 2.0 * reef->metresPerPixel();
  Random random(kReefSeed);
  const auto between = [&](double low, double high) { return low + random.uniform() * (high - low); };
  std::vector<cv::Mat> frames;
  for (int frame = 0; frame < num_frames; ++frame) {
    const double x = between(extent.min_x + margin_m, extent.max_x - margin_m);
    const double y = between(extent.min_y + margin_m, extent.max_y - margin_m);
    const double yaw_rad = between(0.0, 6.283185307179586);
    frames.push_back(reef->render(camera, world::lookingDown({x, y, altitude_m}, yaw_rad)).color);
  }
  return frames;
}

void writeBytes(const std::filesystem::path& file, const std::vector<uint8_t>& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace shoal::vision
