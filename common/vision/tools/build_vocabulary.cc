// SPDX-License-Identifier: BSD-3-Clause
// Trains the binary vocabulary of profile "paper" on pictures in folders. rebuild-vocabularies.sh says on
// which.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "shoal/random.h"
#include "shoal/vision/equalized_channels.h"
#include "shoal/vision/k_majority.h"
#include "shoal/vision/orb_descriptors.h"
#include "shoal/vision/vocabulary.h"
#include "shoal/world/world.h"

namespace {

namespace fs = std::filesystem;
using shoal::vision::BinaryWord;

constexpr int kLongestSide = 1280;   // pixels; larger photographs are shrunk: they are soft at full size
const cv::Size kFrame{320, 240};     // what a robot's camera sees
constexpr size_t kPerChannel = 500;  // descriptors of one channel of one frame, spread over its key points
constexpr uint64_t kReefSeed = 20210530;  // a reef that no mission flies by default
constexpr int kReefFrames = 60;           // of one reef

// Pictures under the folder, by path in byte order, so that a rebuild sees them alike.
std::vector<fs::path> picturesIn(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string kind = entry.path().extension().string();
    if (entry.is_regular_file() && (kind == ".jpg" || kind == ".jpeg" || kind == ".png"))
      files.push_back(entry);
  }
  std::sort(files.begin(), files.end());
  return files;
}

// Photographs shrunk, textures that are smaller than a frame repeated.
cv::Mat load(const fs::path& file) {
  cv::Mat picture = cv::imread(file.string(), cv::IMREAD_COLOR);
  if (picture.empty()) throw std::runtime_error(file.string() + " is not a picture that can be read");
  const double shrink = static_cast<double>(kLongestSide) / std::max(picture.cols, picture.rows);
  if (shrink < 1.0) cv::resize(picture, picture, {}, shrink, shrink, cv::INTER_AREA);
  const int across = (kFrame.width + picture.cols - 1) / picture.cols;
  const int down = (kFrame.height + picture.rows - 1) / picture.rows;
  if (across > 1 || down > 1) cv::repeat(picture.clone(), down, across, picture);
  return picture;
}

void describeFrame(const cv::Mat& frame, std::vector<BinaryWord>& descriptors) {
  for (const cv::Mat& channel : shoal::vision::equalize(frame).lab) {
    const auto found = shoal::vision::orbDescriptors(channel);
    const size_t kept = std::min(found.size(), kPerChannel);
    for (size_t i = 0; i < kept; ++i) descriptors.push_back(found[i * found.size() / kept].bits);
  }
}

void describePicture(const cv::Mat& picture, std::vector<BinaryWord>& descriptors) {
  for (int y = 0; y + kFrame.height <= picture.rows; y += kFrame.height) {
    for (int x = 0; x + kFrame.width <= picture.cols; x += kFrame.width) {
      describeFrame(picture(cv::Rect({x, y}, kFrame)), descriptors);
    }
  }
}

// Frames at random places and headings, at the altitude where a pixel of the camera is one of the reef.
void describeReef(const std::string& spec, std::vector<BinaryWord>& descriptors) {
  const auto reef = shoal::world::openWorld(spec, kReefSeed);
  const shoal::world::Intrinsics camera;
  const shoal::world::Extent extent = reef->extent();
  const double altitude_m = camera.fx * reef->metresPerPixel();
  const double margin_m = std::hypot(camera.width, camera.height) / 2.0 * reef->metresPerPixel();
  shoal::Random random(kReefSeed);
  const auto between = [&](double low, double high) { return low + random.uniform() * (high - low); };
  for (int frame = 0; frame < kReefFrames; ++frame) {
    const double x = between(extent.min_x + margin_m, extent.max_x - margin_m);
    const double y = between(extent.min_y + margin_m, extent.max_y - margin_m);
    const double yaw_rad = between(0.0, 6.283185307179586);
    describeFrame(reef->render(camera, shoal::world::lookingDown({x, y, altitude_m}, yaw_rad)).color,
                  descriptors);
  }
}

void write(const fs::path& file, const std::vector<uint8_t>& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

void describeFolder(const fs::path& folder, std::vector<BinaryWord>& descriptors) {
  for (const fs::path& file : picturesIn(folder)) describePicture(load(file), descriptors);
}

void build(const fs::path& out, const std::vector<std::string>& sources) {
  std::vector<BinaryWord> descriptors;
  for (const std::string& source : sources) {
    const size_t before = descriptors.size();
    source.starts_with("reef:") ? describeReef(source, descriptors) : describeFolder(source, descriptors);
    std::cerr << source << ": " << descriptors.size() - before << " descriptors\n";
  }
  const auto result =
      shoal::vision::kMajority(descriptors, {}, [](int round, int64_t changed, double distance) {
        std::cerr << "round " << round << ": " << changed << " moved, mean distance " << distance
                  << " bits\n";
      });
  const shoal::vision::Vocabulary vocabulary(result.words);
  write(out, vocabulary.serialize());
  std::cerr << out.string() << ": " << vocabulary.size() << " words of " << descriptors.size()
            << " descriptors, fingerprint " << std::hex << vocabulary.fingerprint() << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || std::string(argv[1]).starts_with("-")) {
    std::cerr << "usage: shoal_build_vocabulary OUT.voc FOLDER_OF_PICTURES|reef:STYLE...\n"
                 "Trains 5000 binary words on the sources and writes them. Equal sources give equal bytes.\n";
    return 2;
  }
  try {
    build(argv[1], std::vector<std::string>(argv + 2, argv + argc));
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
