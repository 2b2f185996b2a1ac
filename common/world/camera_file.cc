// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/camera_file.h"

#include <array>
#include <stdexcept>

#include <nlohmann/json.hpp>

#include "shoal/world/json_fields.h"

namespace shoal::world {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

std::optional<double> positive(const fs::path& file, const json& object, const char* key) {
  const json value = object.value(key, json());
  if (value.is_null()) return std::nullopt;
  const double read = number(file, value, std::string("\"") + key + "\"");
  if (!(read > 0)) refuse(file, std::string("\"") + key + "\" must be > 0, got " + value.dump());
  return read;
}

template <size_t n>
std::array<double, n> numbers(const fs::path& file, const json& object, const char* key) {
  const json list = object.value(key, json());
  if (!list.is_array() || list.size() != n) {
    refuse(file, std::string("body_from_camera.") + key + " must be " + std::to_string(n) + " numbers");
  }
  std::array<double, n> read{};
  for (size_t i = 0; i < n; ++i) read[i] = number(file, list[i], std::string("body_from_camera.") + key);
  return read;
}

Pose mounting(const fs::path& file, const json& object) {
  if (!object.is_object()) refuse(file, "\"body_from_camera\" must hold translation_m and quaternion_wxyz");
  const auto t = numbers<3>(file, object, "translation_m");
  const auto q = numbers<4>(file, object, "quaternion_wxyz");
  const Eigen::Quaterniond rotation(q[0], q[1], q[2], q[3]);
  if (std::abs(rotation.norm() - 1.0) > 0.01)
    refuse(file, "body_from_camera.quaternion_wxyz must have length 1");
  Pose body_from_camera = Pose::Identity();
  body_from_camera.translation() = Eigen::Vector3d(t[0], t[1], t[2]);
  body_from_camera.linear() = rotation.normalized().toRotationMatrix();
  return body_from_camera;
}

Camera cameraFrom(const json& object, const fs::path& file) {
  Camera camera;
  const auto need = [&](const char* key) {
    return number(file, object.value(key, json()), std::string("\"") + key + "\"");
  };
  camera.intrinsics.width = integer(file, object.value("width", json()), 1, 16384, "\"width\"");
  camera.intrinsics.height = integer(file, object.value("height", json()), 1, 16384, "\"height\"");
  camera.intrinsics.fx = need("fx");
  camera.intrinsics.fy = need("fy");
  camera.intrinsics.cx = need("cx");
  camera.intrinsics.cy = need("cy");
  try {
    checkCamera(camera.intrinsics, Pose::Identity());
  } catch (const std::invalid_argument& e) {
    refuse(file, e.what());
  }
  camera.depth_factor = positive(file, object, "depth_factor");
  camera.max_depth_m = positive(file, object, "max_depth_m");
  const json classes = object.value("classes", json());
  if (!classes.is_null() && !(classes.is_array() && classes.empty())) {
    camera.classes = truthClasses(file, object);
  }
  const json unlabelled = object.value("unlabelled", json());
  if (!unlabelled.is_null()) camera.unlabelled = integer(file, unlabelled, 0, 255, "\"unlabelled\"");
  const json mounted = object.value("body_from_camera", json());
  if (!mounted.is_null()) camera.body_from_camera = mounting(file, mounted);
  return camera;
}

}  // namespace

Camera parseCamera(const std::string& json_text, const fs::path& origin) {
  try {
    const json parsed = json::parse(json_text);
    if (!parsed.is_object()) refuse(origin, "must be a JSON object, got " + std::string(parsed.type_name()));
    return cameraFrom(parsed, origin);
  } catch (const json::exception& e) {
    refuse(origin, std::string("broken JSON: ") + e.what());
  }
}

Camera readCamera(const fs::path& file) {
  return cameraFrom(
      parseObject(file, "a camera is described by width, height, fx, fy, cx, cy in camera.json"), file);
}

Camera overridden(Camera own, const Camera& given) {
  own.intrinsics = given.intrinsics;
  own.body_from_camera = given.body_from_camera;
  if (given.depth_factor) own.depth_factor = given.depth_factor;
  if (given.max_depth_m) own.max_depth_m = given.max_depth_m;
  if (!given.classes.empty()) {
    own.classes = given.classes;
    own.unlabelled = given.unlabelled;
  }
  return own;
}

}  // namespace shoal::world
