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

#include "shoal/vision/equalized_channels.h"
#include "shoal/vision/k_majority.h"
#include "shoal/vision/orb_descriptors.h"
#include "shoal/vision/vocabulary.h"

namespace {

namespace fs = std::filesystem;
using shoal::vision::BinaryWord;

constexpr int kLongestSide = 1280;   // pixels; larger photographs are shrunk: they are soft at full size
const cv::Size kFrame{320, 240};     // what a robot's camera sees
constexpr size_t kPerChannel = 500;  // descriptors of one channel of one frame, spread over its key points

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

void write(const fs::path& file, const std::vector<uint8_t>& bytes) {
  std::ofstream out(file, std::ios::binary);
  out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

void build(const fs::path& out, const std::vector<fs::path>& folders) {
  std::vector<BinaryWord> descriptors;
  for (const fs::path& folder : folders) {
    const auto files = picturesIn(folder);
    const size_t before = descriptors.size();
    for (const fs::path& file : files) describePicture(load(file), descriptors);
    std::cerr << folder.string() << ": " << files.size() << " pictures, " << descriptors.size() - before
              << " descriptors\n";
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
    std::cerr
        << "usage: shoal_build_vocabulary OUT.voc PICTURE_FOLDER...\n"
           "Trains 5000 binary words on the pictures and writes them. Equal pictures give equal bytes.\n";
    return 2;
  }
  try {
    build(argv[1], std::vector<fs::path>(argv + 2, argv + argc));
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
