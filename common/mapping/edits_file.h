// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/edit.h"

namespace shoal::mapping {

/// An edit as it stands in edits.json and in answers:
///   {"id": "OPERATOR/3", "time_us": 5, "edit": "name", "topics": [{"robot": "R01", "topic": 4, "epoch": 0}],
///    "name": "sand"}; link and unlink have two topics, exclude "robot": "R07", undo "undone": "OPERATOR/2".
nlohmann::ordered_json toJson(const Edit& edit);

/// @throws std::invalid_argument naming what is wrong, nlohmann::json::exception for a missing key.
Edit editFromJson(const nlohmann::ordered_json& json);

/// The text of edits.json: {"mission_id": 5, "edits": [...]}.
std::string editsJson(int64_t mission, std::span<const Edit> edits);

struct EditsFile {
  int64_t mission = 0;
  std::vector<Edit> edits;
};

/// The inverse. Reads anything. @throws std::runtime_error naming `path` and what is wrong.
EditsFile parseEdits(const std::string& text, const std::string& path);

/// The edits in a file; none when there is no such file.
/// @throws std::runtime_error as parseEdits(), and when the file is of another mission.
std::vector<Edit> readEdits(const std::string& path, int64_t mission);

}  // namespace shoal::mapping
