// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/remains.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

namespace fs = std::filesystem;

constexpr std::array<std::string_view, 9> kFiles = {"global_map.csv", "global_map.png", "labels.csv",
                                                    "summary.json",   "summary.html",   "edits.json",
                                                    "library.json",   "mission.lcmlog", "surprise.csv"};
constexpr std::array<std::string_view, 5> kFolders = {"robots", "single", "logs", "state", "pictures"};

// Of a file in one of them.
bool isOfMission(const fs::path& file) {
  const std::string name = file.filename(), kind = file.extension(), stem = file.stem();
  constexpr std::array<std::string_view, 5> kNames = {"map.csv", "poses.txt", "surprise.csv", "topics.json",
                                                      "pictures.json"};
  if (std::ranges::find(kNames, name) != kNames.end()) return true;
  if (kind == ".png") return stem.find_first_not_of("0123456789_") == std::string::npos;
  if (kind.starts_with(".sqlite")) return name.starts_with("mission-");
  return kind == ".log" || kind == ".checkpoint" || kind == ".epoch" || kind.starts_with(".tmp");
}

void removeFrom(const fs::path& folder) {
  std::error_code error;
  std::vector<fs::path> entries;
  for (const auto& entry : fs::directory_iterator(folder, error)) entries.push_back(entry.path());
  for (const fs::path& entry : entries) {
    const std::string name = entry.filename();
    if (!fs::is_directory(fs::symlink_status(entry))) {
      if (isOfMission(entry)) fs::remove(entry);
    } else if (name == "pictures" || name == "robots" || world::parseRobotId(name)) {
      removeFrom(entry);
    }
  }
  fs::remove(folder, error);  // if nothing is left in it
}

}  // namespace

void removeMission(const std::string& dir) {
  for (const std::string_view name : kFiles) fs::remove(fs::path(dir) / name);
  for (const std::string_view name : kFolders) removeFrom(fs::path(dir) / name);
}

std::string fileOfMission(const std::string& dir) {
  std::error_code error;
  for (const std::string_view name : kFiles)
    if (fs::exists(fs::path(dir) / name, error)) return std::string(name);
  return "";
}

std::vector<std::string> remainsOf(const std::string& dir) {
  std::error_code error;
  std::vector<std::string> remains, remembered;
  for (const char* name : {"mission.lcmlog", "edits.json"})
    if (fs::exists(fs::path(dir) / name, error)) remains.emplace_back(name);
  for (const auto& entry : fs::directory_iterator(fs::path(dir) / "state", error)) {
    if (entry.path().extension() == ".sqlite")
      remembered.push_back("state/" + entry.path().filename().string());
  }
  std::ranges::sort(remembered);
  remains.insert(remains.end(), remembered.begin(), remembered.end());
  return remains;
}

std::string howToAsk(const std::string& dir) {
  for (const std::string& name : remainsOf(dir)) {
    if (name != "edits.json") return "operator_console labels --log " + (fs::path(dir) / name).string();
  }
  return "";
}

}  // namespace shoal::console
