// SPDX-License-Identifier: BSD-3-Clause
// Trains the binary vocabulary of profile "paper" on pictures in folders. rebuild-vocabularies.sh says on
// which.
#include <algorithm>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "shoal/vision/equalized_channels.h"
#include "shoal/vision/k_majority.h"
#include "shoal/vision/orb_descriptors.h"
#include "shoal/vision/tools/training_pictures.h"
#include "shoal/vision/vocabulary.h"

namespace {

namespace fs = std::filesystem;
using shoal::vision::BinaryWord;

constexpr int kLongestSide = 1280;   // pixels; larger photographs are shrunk: they are soft at full size
const cv::Size kFrame{320, 240};     // what a robot's camera sees
constexpr size_t kPerChannel = 500;  // descriptors of one channel of one frame, spread over its key points
constexpr int kReefFrames = 60;      // of one reef

// Photographs shrunk, textures that are smaller than a frame repeated.
cv::Mat load(const fs::path& file) {
  cv::Mat picture = shoal::vision::loadPicture(file, kLongestSide);
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

void describeReef(const std::string& spec, std::vector<BinaryWord>& descriptors) {
  for (const cv::Mat& frame : shoal::vision::reefFrames(spec, kReefFrames)) describeFrame(frame, descriptors);
}

void describeFolder(const fs::path& folder, std::vector<BinaryWord>& descriptors) {
  for (const fs::path& file : shoal::vision::picturesIn(folder)) describePicture(load(file), descriptors);
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
  shoal::vision::writeBytes(out, vocabulary.serialize());
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
