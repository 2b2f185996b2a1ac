// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/recording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <system_error>

#include <opencv2/imgcodecs.hpp>

#include "shoal/demand.h"
#include "shoal/world/flat_floor.h"
#include "shoal/world/json_fields.h"
#include "shoal/world/stamped_files.h"

namespace shoal::world {
namespace {

namespace fs = std::filesystem;

constexpr uint8_t kUnlabelled = 255;
constexpr uint16_t kNoDepth = 65535;  // of sensors that say so; 0 is none everywhere

std::string sizeOf(const cv::Mat& image) {
  return std::to_string(image.cols) + " x " + std::to_string(image.rows);
}

cv::Size sizeOf(const Intrinsics& camera) { return {camera.width, camera.height}; }

/// Empty when it cannot be decoded.
cv::Mat readPicture(const fs::path& file, int flags) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  try {
    return cv::imread(file.string(), flags | cv::IMREAD_IGNORE_ORIENTATION);
  } catch (const cv::Exception&) {
    return {};
  }
}

/// The entry nearest in time within the tolerance; the earlier on a tie.
std::optional<fs::path> nearest(const std::vector<StampedFile>& files, Timestamp time, int64_t tolerance_us) {
  const auto after = std::ranges::lower_bound(files, time, {}, &StampedFile::time);
  std::optional<fs::path> best;
  int64_t best_us = tolerance_us;
  if (after != files.end() && after->time.us - time.us <= best_us) {
    best = after->file;
    best_us = after->time.us - time.us;
  }
  if (after != files.begin() && time.us - std::prev(after)->time.us <= best_us) best = std::prev(after)->file;
  return best;
}

template <typename Entry>
void noteLines(Recording& recording, const std::string& name, const StampedList<Entry>& list) {
  if (list.bad_lines > 0) {
    recording.left_out.push_back(std::to_string(list.bad_lines) + " unreadable entries of " + name);
  }
  if (list.duplicates > 0) {
    recording.left_out.push_back(std::to_string(list.duplicates) + " entries of " + name +
                                 " at a time twice");
  }
}

/// Finds on the first picture that can be decoded what would be wrong with all of them.
void checkSizes(const Recording& recording) {
  const Intrinsics& camera = recording.camera.intrinsics;
  const auto expected = std::to_string(camera.width) + " x " + std::to_string(camera.height);
  const auto check = [&](const fs::path& file, const cv::Mat& picture, int type, const std::string& what) {
    if (picture.empty()) return;
    if (picture.type() != type) refuse(file, what);
    if (picture.size() == sizeOf(camera)) return;
    refuse(file, "is " + sizeOf(picture) + " pixels, but the camera is " + expected +
                     "; colour, depth and labels must have the camera's size");
  };
  if (recording.frames.empty()) return;
  const RecordedFrame& first = recording.frames.front();
  check(first.color, readPicture(first.color, cv::IMREAD_COLOR), CV_8UC3, "must be a colour picture");
  if (first.depth) {
    if (!recording.camera.depth_factor) {
      refuse(recording.folder / "camera.json",
             "\"depth_factor\" is missing, but there is depth: metres = value / depth_factor, as 1000");
    }
    check(*first.depth, readPicture(*first.depth, cv::IMREAD_UNCHANGED), CV_16UC1,
          "a depth picture must have one channel of 16 bits");
  }
  if (first.labels) {
    check(*first.labels, readPicture(*first.labels, cv::IMREAD_UNCHANGED), CV_8UC1,
          "a label picture must have one channel of 8 bits: a class id per pixel");
  }
}

cv::Mat knownLabels(const cv::Mat& raw, const Camera& camera) {
  std::array<uint8_t, 256> known;
  known.fill(kUnlabelled);
  for (const TruthClass& c : camera.classes) {
    if (c.id != camera.unlabelled) known[static_cast<size_t>(c.id)] = static_cast<uint8_t>(c.id);
  }
  cv::Mat labels(raw.size(), CV_8UC1);
  for (int v = 0; v < raw.rows; ++v) {
    const auto* from = raw.ptr<uint8_t>(v);
    std::transform(from, from + raw.cols, labels.ptr<uint8_t>(v), [&](uint8_t id) { return known[id]; });
  }
  return labels;
}

}  // namespace

cv::Mat depthInMetres(const cv::Mat& raw, const Camera& camera) {
  SHOAL_DEMAND(raw.type() == CV_16UC1 && camera.depth_factor);
  const double farthest = camera.max_depth_m.value_or(HUGE_VAL);
  cv::Mat depth_m(raw.size(), CV_32FC1);
  for (int v = 0; v < raw.rows; ++v) {
    const auto* from = raw.ptr<uint16_t>(v);
    std::transform(from, from + raw.cols, depth_m.ptr<float>(v), [&](uint16_t value) {
      const double metres = value / *camera.depth_factor;
      return value == kNoDepth || metres > farthest ? 0.0f : static_cast<float>(metres);
    });
  }
  return depth_m;
}

Recording readRecording(const fs::path& folder, const std::optional<Camera>& given,
                        const PairingOptions& pairing) {
  Recording recording;
  recording.folder = folder;
  std::error_code error;
  if (fs::exists(folder / "camera.json", error) || !given) {
    recording.camera = readCamera(folder / "camera.json");
    if (given) recording.camera = overridden(recording.camera, *given);
  } else {
    recording.camera = *given;
  }
  const auto color = readPictureList(folder, "rgb");
  if (!color) refuse(folder, "has neither rgb.txt nor a folder rgb with the pictures");
  if (!fs::exists(folder / "groundtruth.txt", error)) {
    refuse(folder / "groundtruth.txt", "not found; a recording needs poses: timestamp tx ty tz qx qy qz qw");
  }
  const auto poses = readPoseList(folder / "groundtruth.txt");
  const auto depth = readPictureList(folder, "depth"), labels = readPictureList(folder, "labels");
  noteLines(recording, "rgb.txt", *color);
  noteLines(recording, "groundtruth.txt", poses);
  if (depth) noteLines(recording, "depth.txt", *depth);
  if (labels) noteLines(recording, "labels.txt", *labels);

  PoseTrack track(pairing);
  for (const TimedPose& pose : poses.entries) track.add(pose);
  int without_pose = 0;
  for (const StampedFile& picture : color->entries) {
    const auto pose = track.at(picture.time);
    if (!pose) {
      ++without_pose;
      continue;
    }
    RecordedFrame frame{picture.time, picture.file, {}, {}, *pose};
    if (depth) frame.depth = nearest(depth->entries, picture.time, pairing.tolerance_us);
    if (labels) frame.labels = nearest(labels->entries, picture.time, pairing.tolerance_us);
    recording.labelled = recording.labelled || frame.labels;
    recording.frames.push_back(std::move(frame));
  }
  if (without_pose > 0)
    recording.left_out.push_back(std::to_string(without_pose) + " pictures without a pose");
  if (recording.frames.empty()) {
    refuse(folder,
           "none of its " + std::to_string(color->entries.size()) +
               " pictures has a pose in groundtruth.txt near its time; stamps are seconds on one clock");
  }
  if (recording.labelled && recording.camera.classes.empty()) {
    refuse(folder / "camera.json", "\"classes\" must list {id, name, rgb}, for there are labels");
  }
  checkSizes(recording);
  return recording;
}

std::optional<Observation> loadFrame(const Recording& recording, const RecordedFrame& frame,
                                     double altitude_m, std::string& trouble) {
  const auto say = [&trouble](const char* what) {
    trouble = what;
    return std::nullopt;
  };
  const Camera& camera = recording.camera;
  const cv::Size size = sizeOf(camera.intrinsics);
  Observation seen;
  seen.intrinsics = camera.intrinsics;
  seen.world_from_camera = frame.world_from_camera;
  if (!frame.depth && !(altitude_m > 0)) return say("no depth picture near in time");
  seen.color = readPicture(frame.color, cv::IMREAD_COLOR);
  if (seen.color.empty()) return say("colour picture missing or unreadable");
  if (seen.color.size() != size) return say("colour picture of another size");
  if (frame.depth) {
    if (!camera.depth_factor) return say("depth without a depth_factor");
    const cv::Mat raw = readPicture(*frame.depth, cv::IMREAD_UNCHANGED);
    if (raw.empty()) return say("depth picture missing or unreadable");
    if (raw.type() != CV_16UC1) return say("depth picture not of 16 bits");
    if (raw.size() != size) return say("depth picture of another size");
    seen.depth_m = depthInMetres(raw, camera);
  } else {
    seen.depth_m = flatFloorDepth(camera.intrinsics, frame.world_from_camera, altitude_m);
  }
  if (frame.labels) {
    const cv::Mat raw = readPicture(*frame.labels, cv::IMREAD_UNCHANGED);
    if (raw.type() == CV_8UC1 && raw.size() == size) {
      seen.labels = knownLabels(raw, camera);
    } else {
      trouble = "label picture unreadable (flown without)";
    }
  }
  return seen;
}

}  // namespace shoal::world
