// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/remains.h"

#include <algorithm>
#include <filesystem>

namespace shoal::console {

std::vector<std::string> remainsOf(const std::string& dir) {
  namespace fs = std::filesystem;
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
    if (name != "edits.json")
      return "operator_console labels --log " + (std::filesystem::path(dir) / name).string();
  }
  return "";
}

}  // namespace shoal::console
