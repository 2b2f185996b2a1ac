// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

namespace shoal::vision {

/// Pictures (.jpg, .jpeg, .png) under a folder, by path in byte order, so that a rebuild sees them alike.
std::vector<std::filesystem::path> picturesIn(const std::filesystem::path& folder);

/// A picture in colour, shrunk when its longer side exceeds `longest_side` pixels.
/// @throws std::runtime_error naming a file that cannot be read.
cv::Mat loadPicture(const std::filesystem::path& file, int longest_side);

/// Frames of 320 x 240 of a reef (its pixels, seed 20210530: one that no mission flies by default), at random
/// places and headings, at the altitude where a pixel of the camera is one of the reef.
std::vector<cv::Mat> reefFrames(const std::string& spec, int num_frames);

/// @throws std::runtime_error naming a file that cannot be written.
void writeBytes(const std::filesystem::path& file, const std::vector<uint8_t>& bytes);

}  // namespace shoal::vision
