// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/bag/import_bag.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <Eigen/Geometry>
#include <opencv2/imgcodecs.hpp>

#include "operator_console/bag/bag_reader.h"
#include "operator_console/bag/ros_messages.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/world/camera_file.h"

namespace shoal::console {
namespace {

namespace fs = std::filesystem;
using TypesByTopic = std::map<std::string, std::string>;  // types by name

constexpr const char* kImage = "sensor_msgs/msg/Image";
constexpr const char* kCompressed = "sensor_msgs/msg/CompressedImage";
constexpr const char* kCameraInfo = "sensor_msgs/msg/CameraInfo";
constexpr const char* kOdometry = "nav_msgs/msg/Odometry";
constexpr const char* kPose = "geometry_msgs/msg/PoseStamped";
constexpr const char* kPoseWithCovariance = "geometry_msgs/msg/PoseWithCovarianceStamped";

bool saysDepth(const std::string& topic) { return topic.find("depth") != std::string::npos; }

std::string listed(const std::vector<std::string>& topics) {
  std::string text;
  for (const std::string& topic : topics) text += (text.empty() ? "" : ", ") + topic;
  return text;
}

// The topic that is meant: the one given, or the only one that could be.
template <typename Fits>
std::string chosen(const TypesByTopic& topics, const std::string& given, const std::string& flag, bool needed,
                   Fits&& fits) {
  std::vector<std::string> fitting;
  for (const auto& [topic, type] : topics)
    if (fits(topic, type)) fitting.push_back(topic);
  if (!given.empty()) {
    if (topics.contains(given) && fits(given, topics.at(given), true)) return given;
    throw std::invalid_argument(flag + " " + given +
                                " is not in the bag, or not of a type that is read; it could be: " +
                                (fitting.empty() ? "none" : listed(fitting)));
  }
  if (fitting.size() == 1) return fitting.front();
  if (fitting.empty() && !needed) return "";
  std::vector<std::string> all;
  for (const auto& [topic, type] : topics) all.push_back(topic + " (" + type + ")");
  throw std::invalid_argument(fitting.empty()
                                  ? "nothing in the bag will do for " + flag + "; it holds: " + listed(all)
                                  : "several topics could be meant, say " + flag + ": " + listed(fitting));
}

Imported topicsOf(const ImportOptions& options) {
  TypesByTopic topics;
  readBag(options.bag, [&](const BagMessage& m) { topics.try_emplace(m.topic, m.type); });
  const auto isPicture = [](const std::string& type) { return type == kImage || type == kCompressed; };
  Imported found;
  found.depth = chosen(topics, options.depth, "--depth", false,
                       [&](const std::string& topic, const std::string& type, bool given = false) {
                         return isPicture(type) && (given || saysDepth(topic));
                       });
  found.image = chosen(topics, options.image, "--image", true,
                       [&](const std::string& topic, const std::string& type, bool given = false) {
                         return isPicture(type) && topic != found.depth && (given || !saysDepth(topic));
                       });
  found.pose = chosen(topics, options.pose, "--pose", true,
                      [&](const std::string&, const std::string& type, bool = false) {
                        return type == kOdometry || type == kPose || type == kPoseWithCovariance;
                      });
  if (options.camera.empty()) {
    found.info = chosen(topics, options.info, "--info", true,
                        [&](const std::string& topic, const std::string& type, bool given = false) {
                          return type == kCameraInfo && (given || !saysDepth(topic));
                        });
  }
  return found;
}

std::string secondsText(const RosStamp& stamp) {
  return fmt::format("{}.{:06}", stamp.us / 1'000'000, stamp.us % 1'000'000);
}

// Lines of a list, ascending by time, however they came.
class List {
 public:
  void add(const RosStamp& stamp, std::string line) { lines_.emplace(stamp.us, std::move(line)); }
  bool has(const RosStamp& stamp) const { return lines_.contains(stamp.us); }
  void write(const fs::path& file, const std::string& head) const {
    std::string text = head;
    for (const auto& [time, line] : lines_) text += line + '\n';
    mapping::writeFileAtomically(file, text);
  }

 private:
  std::map<int64_t, std::string> lines_;
};

class Import {
 public:
  Import(const ImportOptions& options, Imported found) : options_(options), found_(std::move(found)) {
    const auto& b = options.body_from_camera;
    body_from_camera_.translation() = Eigen::Vector3d(b[0], b[1], b[2]);
    body_from_camera_.linear() = Eigen::Quaterniond(b[6], b[3], b[4], b[5]).normalized().toRotationMatrix();
  }

  Imported run() {
    const fs::path folder = options_.folder;
    fs::create_directories(folder / "rgb");
    if (!found_.depth.empty()) fs::create_directories(folder / "depth");
    readBag(options_.bag, [this](const BagMessage& m) { look(m); });
    writeCamera(folder / "camera.json");
    rgb_.write(folder / "rgb.txt", "# timestamp filename\n");
    if (!found_.depth.empty()) depth_.write(folder / "depth.txt", "# timestamp filename\n");
    poses_.write(folder / "groundtruth.txt", "# timestamp tx ty tz qx qy qz qw\n");
    if (found_.images == 0)
      throw std::runtime_error(options_.bag + ": no picture of " + found_.image + " could be read" + why());
    if (found_.poses == 0)
      throw std::runtime_error(options_.bag + ": no pose of " + found_.pose + " could be read" + why());
    return found_;
  }

 private:
  std::string why() const { return found_.left_out.empty() ? "" : "; " + found_.left_out.begin()->first; }

  void look(const BagMessage& m) {
    std::string trouble;
    if (m.topic == found_.image || m.topic == found_.depth) {
      const bool is_depth = m.topic == found_.depth;
      const auto picture = m.type == kImage ? readImage(m.data, is_depth, trouble)
                                            : readCompressedImage(m.data, is_depth, trouble);
      if (picture) keep(*picture, is_depth);
    } else if (m.topic == found_.pose) {
      if (const auto pose = readPose(m.data, m.type == kOdometry, trouble)) keep(*pose);
    } else if (m.topic == found_.info && !camera_) {
      camera_ = readCameraInfo(m.data, trouble);
    }
    if (!trouble.empty()) ++found_.left_out[m.topic + ": " + trouble];
  }

  void keep(const RosPicture& picture, bool is_depth) {
    List& list = is_depth ? depth_ : rgb_;
    const std::string name = std::string(is_depth ? "depth/" : "rgb/") + secondsText(picture.stamp) + ".png";
    if (list.has(picture.stamp)) {
      ++found_.left_out["a second picture of the same time"];
      return;
    }
    const std::string file = options_.folder + "/" + name;
    if (!cv::imwrite(file, picture.pixels, {cv::IMWRITE_PNG_COMPRESSION, 1}))
      throw std::runtime_error(file + " cannot be written");
    list.add(picture.stamp, secondsText(picture.stamp) + " " + name);
    ++(is_depth ? found_.depths : found_.images);
    if (!is_depth && width_ == 0) {
      width_ = picture.pixels.cols;
      height_ = picture.pixels.rows;
    }
  }

  void keep(const RosPose& pose) {
    if (poses_.has(pose.stamp)) {
      ++found_.left_out["a second pose of the same time"];
      return;
    }
    const auto& [x, y, z, w] = pose.orientation;
    Eigen::Isometry3d world_from_body = Eigen::Isometry3d::Identity();
    world_from_body.translation() = Eigen::Vector3d(pose.position.data());
    world_from_body.linear() = Eigen::Quaterniond(w, x, y, z).normalized().toRotationMatrix();
    const Eigen::Isometry3d camera = world_from_body * body_from_camera_;
    const Eigen::Vector3d t = camera.translation();
    Eigen::Quaterniond q(camera.linear());
    if (q.w() < 0) q.coeffs() = -q.coeffs();
    poses_.add(pose.stamp,
               fmt::format("{} {:.6f} {:.6f} {:.6f} {:.9f} {:.9f} {:.9f} {:.9f}", secondsText(pose.stamp),
                           t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()));
    ++found_.poses;
  }

  void writeCamera(const fs::path& file) {
    if (!options_.camera.empty()) {
      world::readCamera(options_.camera);
      mapping::writeFileAtomically(file, mapping::readFile(options_.camera));
      return;
    }
    if (!camera_)
      throw std::runtime_error(options_.bag + ": no camera info of " + found_.info + " could be read" +
                               why());
    found_.distorted = camera_->distorted;
    if (width_ > 0 && (static_cast<int64_t>(camera_->width) != width_ ||
                       static_cast<int64_t>(camera_->height) != height_)) {
      throw std::runtime_error(
          fmt::format("{} is of {} x {} pixels, the pictures of {} have {} x {}; give --info or --camera",
                      found_.info, camera_->width, camera_->height, found_.image, width_, height_));
    }
    nlohmann::ordered_json json{{"width", camera_->width}, {"height", camera_->height}, {"fx", camera_->fx},
                                {"fy", camera_->fy},       {"cx", camera_->cx},         {"cy", camera_->cy}};
    if (!found_.depth.empty()) json["depth_factor"] = 1000;
    mapping::writeFileAtomically(file, json.dump(1) + "\n");
  }

  const ImportOptions& options_;
  Imported found_;
  Eigen::Isometry3d body_from_camera_ = Eigen::Isometry3d::Identity();
  List rgb_, depth_, poses_;
  std::optional<RosCamera> camera_;
  int64_t width_ = 0, height_ = 0;
};

}  // namespace

Imported importBag(const ImportOptions& options) {
  if (fs::exists(options.folder) && !fs::is_empty(options.folder)) {
    throw std::invalid_argument("--out " + options.folder + " holds something already; name another folder");
  }
  const auto& b = options.body_from_camera;
  if (std::abs(b[3] * b[3] + b[4] * b[4] + b[5] * b[5] + b[6] * b[6] - 1) > 0.1) {
    throw std::invalid_argument("--camera-on-body ends with a quaternion x y z w of length 1");
  }
  return Import(options, topicsOf(options)).run();
}

}  // namespace shoal::console
