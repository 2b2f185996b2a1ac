// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/picture_files.h"

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "shoal/mapping/atomic_file.h"
#include "shoal/wire/picture_coder.h"

namespace shoal::fusion_node {
namespace {

std::string png(const mapping::HeldPicture& picture) {
  std::vector<uint8_t> bytes;
  cv::imencode(".png", pixelsOf(picture), bytes);
  return {bytes.begin(), bytes.end()};
}

std::string fileName(int32_t id, size_t which) {
  return std::to_string(id) + (which == 0 ? "" : "_" + std::to_string(which)) + ".png";
}

}  // namespace

cv::Mat pixelsOf(const mapping::HeldPicture& picture) {
  const std::vector<uint8_t> rgb = wire::decodePicture(picture.layers);
  cv::Mat pixels(wire::kPictureEdge, wire::kPictureEdge, CV_8UC3);
  for (int y = 0; y < pixels.rows; ++y) {
    for (int x = 0; x < pixels.cols; ++x) {
      const uint8_t* from = &rgb[3 * static_cast<size_t>(y * pixels.cols + x)];
      pixels.at<cv::Vec3b>(y, x) = {from[2], from[1], from[0]};
    }
  }
  return pixels;
}

std::vector<std::string> writeLabelPictures(const std::string& folder,
                                            const mapping::LabelPictures& pictures) {
  std::vector<std::string> files;
  if (pictures.empty()) return files;
  nlohmann::ordered_json index = mapping::picturesAnswer(pictures);
  size_t row = 0;
  for (const auto& [label, held] : pictures) {
    for (size_t i = 0; i < held.size(); ++i) {
      files.push_back(fileName(number(label), i));
      mapping::writeFileAtomically(folder + "/" + files.back(), png(held[i]));
      index["labels"][row]["pictures"][i]["file"] = files.back();
    }
    ++row;
  }
  files.emplace_back("pictures.json");
  mapping::writeFileAtomically(folder + "/" + files.back(), index.dump(1) + "\n");
  return files;
}

std::vector<std::string> writeTopicPictures(const std::string& folder, const mapping::BeliefStore& beliefs,
                                            world::RobotId robot) {
  std::vector<std::string> files;
  for (const mapping::HeldPicture& picture : mapping::heldPictures(beliefs)) {
    if (picture.robot != robot) continue;
    files.push_back(fileName(number(picture.topic), static_cast<size_t>(picture.number)));
    mapping::writeFileAtomically(folder + "/" + files.back(), png(picture));
  }
  return files;
}

}  // namespace shoal::fusion_node
