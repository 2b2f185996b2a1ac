// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shoal/world/camera_file.h"
#include "shoal/world/observation.h"
#include "shoal/world/pose_track.h"

namespace shoal::world {

/// One picture of a recording with what goes with it.
struct RecordedFrame {
  Timestamp time;  ///< the recording's own stamp
  std::filesystem::path color;
  std::optional<std::filesystem::path> depth, labels;
  Pose world_from_camera = Pose::Identity();
};

/// One robot's RGB-D recording in TUM layout: which pictures go together. The pictures stay on disk.
struct Recording {
  std::filesystem::path folder;
  Camera camera;
  std::vector<RecordedFrame> frames;  ///< ascending by time; those without a pose are left out
  std::vector<std::string> left_out;  ///< what was left out so far and why, for people
  bool labelled = false;              ///< some frame has labels
};

/// Reads FOLDER/camera.json, groundtruth.txt (camera optical frame to world) and the lists rgb, depth and
/// labels (the last two perhaps absent). A colour picture goes with the depth picture and the labels nearest
/// in time within the tolerance, and with the pose as PoseTrack::at(). The first picture of each kind is
/// looked at, to find at once what is wrong with all.
/// @param given  says instead of camera.json, or beside it, what it says: see overridden().
/// @throws std::invalid_argument naming the file that is missing or wrong and what would be right.
Recording readRecording(const std::filesystem::path& folder, const std::optional<Camera>& given = {},
                        const PairingOptions& pairing = {});

/// Reads the pictures of a frame. Without a depth picture the floor is flat, altitude_m below the camera,
/// when that is > 0. Depth 0 and the largest 16-bit number are none, as is what lies beyond max_depth_m.
/// Labels that are no class are unlabelled. Number and time are the caller's.
/// @param trouble  why there is nothing, or only a part: a phrase for people; untouched when all is well.
std::optional<Observation> loadFrame(const Recording& recording, const RecordedFrame& frame,
                                     double altitude_m, std::string& trouble);

/// A 16-bit depth picture as metres, CV_32FC1. @param raw  CV_16UC1. @param camera  has a depth_factor.
cv::Mat depthInMetres(const cv::Mat& raw, const Camera& camera);

}  // namespace shoal::world
