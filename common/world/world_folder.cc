// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/world_folder.h"

#include <fstream>
#include <stdexcept>
#include <system_error>

#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

namespace shoal::world {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

[[noreturn]] void refuse(const fs::path& file, const std::string& why) {
  throw std::invalid_argument(file.string() + ": " + why);
}

json parse(const fs::path& file) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) refuse(file, "not found; a world folder holds world.json");
  std::ifstream in(file);
  if (!in) refuse(file, "cannot be read");
  try {
    json parsed = json::parse(in);  // its message has line and column
    if (!parsed.is_object()) refuse(file, "must be a JSON object, got " + std::string(parsed.type_name()));
    return parsed;
  } catch (const json::parse_error& e) {
    refuse(file, std::string("broken JSON: ") + e.what());
  }
}

std::string text(const fs::path& file, const json& object, const char* key, const std::string& meaning) {
  const auto found = object.find(key);
  if (found == object.end() || !found->is_string() || found->get<std::string>().empty()) {
    refuse(file, std::string("\"") + key + "\" must be " + meaning);
  }
  return found->get<std::string>();
}

/// An integer in [low, high].
int integer(const fs::path& file, const json& value, int low, int high, const std::string& what) {
  const bool good = value.is_number_integer() && value.get<double>() >= low && value.get<double>() <= high;
  if (!good) {
    refuse(file, what + " must be an integer in [" + std::to_string(low) + ", " + std::to_string(high) +
                     "], got " + value.dump());
  }
  return value.get<int>();
}

cv::Size pictureSize(const fs::path& file, const json& world) {
  const auto size = world.find("size_px");
  if (size == world.end() || !size->is_array() || size->size() != 2) {
    refuse(file, "\"size_px\" must be [width, height] in pixels");
  }
  constexpr int kMaxSide = 1 << 16;
  return {integer(file, (*size)[0], 1, kMaxSide, "size_px[0]"),
          integer(file, (*size)[1], 1, kMaxSide, "size_px[1]")};
}

std::vector<TruthClass> truthClasses(const fs::path& file, const json& world) {
  const auto listed = world.find("classes");
  if (listed == world.end() || !listed->is_array() || listed->empty()) {
    refuse(file, "\"classes\" must list {id, name, rgb} for the ids in \"labels\"");
  }
  std::vector<TruthClass> classes;
  for (const json& entry : *listed) {
    const std::string where = "classes[" + std::to_string(classes.size()) + "]";
    if (!entry.is_object()) refuse(file, where + " must be an object with id, name and rgb");
    TruthClass c;
    c.id = integer(file, entry.value("id", json()), 0, 254, where + ".id");
    for (const TruthClass& other : classes) {
      if (other.id == c.id)
        refuse(file, where + ".id must be distinct, got " + std::to_string(c.id) + " again");
    }
    c.name = text(file, entry, "name", "the name of " + where);
    const json rgb = entry.value("rgb", json());
    if (!rgb.is_array() || rgb.size() != 3) refuse(file, where + ".rgb must be three integers in [0, 255]");
    for (size_t i = 0; i < 3; ++i) {
      c.rgb[i] =
          static_cast<uint8_t>(integer(file, rgb[i], 0, 255, where + ".rgb[" + std::to_string(i) + "]"));
    }
    classes.push_back(std::move(c));
  }
  return classes;
}

cv::Mat readPicture(const fs::path& file, int flags, const cv::Size& size) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) refuse(file, "not found, but world.json names it");
  cv::Mat picture;
  try {
    picture = cv::imread(file.string(), flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception& e) {
    refuse(file, "cannot be decoded: " + e.msg);
  }
  if (picture.empty()) refuse(file, "is no picture that can be decoded");
  if (picture.size() != size) {
    refuse(file, "is " + std::to_string(picture.cols) + " x " + std::to_string(picture.rows) +
                     " pixels, but size_px in world.json says " + std::to_string(size.width) + " x " +
                     std::to_string(size.height));
  }
  return picture;
}

}  // namespace

std::unique_ptr<OrthoWorld> readWorldFolder(const fs::path& folder) {
  const fs::path file = folder / "world.json";
  const json world = parse(file);
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
    labels = readPicture(labels_file, cv::IMREAD_UNCHANGED, size);
    if (labels.type() != CV_8UC1)
      refuse(labels_file, "must have one channel of 8 bits: a class id per pixel");
  }
  cv::Mat color = readPicture(folder / image, cv::IMREAD_COLOR, size);
  try {
    return std::make_unique<OrthoWorld>(name, std::move(color), std::move(labels), scale.get<double>(),
                                        std::move(classes));
  } catch (const std::invalid_argument& e) {
    refuse(labelled ? folder / world["labels"].get<std::string>() : file, e.what());
  }
}

}  // namespace shoal::world
