// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "shoal/world/ids.h"
#include "shoal/world/pose_track.h"

namespace shoal::world {

/// A picture of a recording, and when it was taken.
struct StampedFile {
  Timestamp time;  ///< the recording's own stamp
  std::filesystem::path file;
};

/// What a list of a TUM folder holds: ascending by time, each time once (the first line that says it).
template <typename Entry>
struct StampedList {
  std::vector<Entry> entries;
  int bad_lines = 0;   ///< not in the format, and left out
  int duplicates = 0;  ///< of a time that was there already, and left out
};

/// Reads FOLDER/KIND.txt: a line a picture, `timestamp filename`, seconds and a path relative to the folder;
/// separated by blanks, tabs or commas, in any order, comments begin with #, lines end with LF or CRLF. Where
/// there is no such file, the pictures FOLDER/KIND/*.png, .jpg and .jpeg by their names, which are their
/// times. Nothing when there is neither.
std::optional<StampedList<StampedFile>> readPictureList(const std::filesystem::path& folder,
                                                        const std::string& kind);

/// Reads groundtruth.txt: a line a pose, `timestamp tx ty tz qx qy qz qw`, otherwise as above. What is not
/// finite, or has a quaternion whose length is not about 1, is a bad line.
/// @throws std::invalid_argument when the file cannot be read.
StampedList<TimedPose> readPoseList(const std::filesystem::path& file);

/// Seconds as microseconds; nothing for what is no number, or no time within 10^11 s of 0.
std::optional<Timestamp> parseSeconds(std::string_view text);

}  // namespace shoal::world
