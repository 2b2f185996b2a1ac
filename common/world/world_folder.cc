// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/world_folder.h"

#include <stdexcept>
#include <system_error>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "shoal/world/json_fields.h"

namespace shoal::world {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

cv::Size pictureSize(const fs::path& file, const json& world) {
  const auto size = world.find("size_px");
  if (size == world.end() || !size->is_array() || size->size() != 2) {
    refuse(file, "\"size_px\" must be [width, height] in pixels");
  }
  constexpr int kMaxSide = 1 << 16;
  return {integer(file, (*size)[0], 1, kMaxSide, "size_px[0]"),
          integer(file, (*size)[1], 1, kMaxSide, "size_px[1]")};
}

// The picture that the world's file names; errors name both, since a picture may lie in another folder.
cv::Mat readPicture(const fs::path& file, const fs::path& world_file, int flags, const cv::Size& size) {
  const std::string named_by = ", but " + world_file.string() + " names it";
  std::error_code error;
  if (!fs::is_regular_file(file, error)) refuse(file, "not found" + named_by);
  cv::Mat picture;
  try {
    picture = cv::imread(file.string(), flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& e) {
    refuse(file, "cannot be decoded" + named_by + ": " + e.msg);
  }
  if (picture.empty()) refuse(file, "is no picture that can be decoded" + named_by);
  if (picture.size() != size) {
    refuse(file, "is " + std::to_string(picture.cols) + " x " + std::to_string(picture.rows) +
                     " pixels, but size_px in " + world_file.string() + " says " +
                     std::to_string(size.width) + " x " + std::to_string(size.height));
  }
  return picture;
}

}  // namespace

std::unique_ptr<OrthoWorld> readWorldFolder(const fs::path& folder) {
  const fs::path file = folder / "world.json";
  const json world = parseObject(file, "a world folder holds world.json");
  const std::string name = world.contains("name")
                               ? text(file, world, "name", "the name of the world")
                               : fs::absolute(folder / "world.json").parent_path().filename().string();
  const json scale = world.value("metres_per_pixel", json());
  if (!scale.is_number() || !(scale.get<double>() > 0.0)) {
    refuse(file, "\"metres_per_pixel\" must be a number > 0, got " + scale.dump());
  }
  if (const json unlabelled = world.value("unlabelled", json(255)); unlabelled != json(255)) {
    refuse(file, "\"unlabelled\" must be 255, got " + unlabelled.dump());
  }
  const cv::Size size = pictureSize(file, world);
  const std::string image = text(file, world, "image", "the file name of the picture");
  const bool labelled = world.contains("labels") || world.contains("classes");
  std::vector<TruthClass> classes;
  cv::Mat labels;
  if (labelled) {
    classes = truthClasses(file, world);
    const fs::path labels_file = folder / text(file, world, "labels", "the file name of the label picture");
    labels = readPicture(labels_file, file, cv::IMREAD_UNCHANGED, size);
    if (labels.type() != CV_8UC1)
      refuse(file, labels_file.string() + " must have one channel of 8 bits: a class id per pixel");
  }
  cv::Mat color = readPicture(folder / image, file, cv::IMREAD_COLOR, size);
  try {
    return std::make_unique<OrthoWorld>(name, std::move(color), std::move(labels), scale.get<double>(),
                                        std::move(classes));
  } catch (const std::invalid_argument& e) {
    refuse(file, (labelled ? (folder / world["labels"].get<std::string>()).string() + ": " : "") + e.what());
  }
}

}  // namespace shoal::world
