// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/stamped_files.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <system_error>

namespace shoal::world {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBlanks = " \t,\r";

std::optional<double> parseNumber(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

// Takes the first field off a line.
std::string_view takeField(std::string_view& line) {
  line.remove_prefix(std::min(line.find_first_not_of(kBlanks), line.size()));
  const std::string_view field = line.substr(0, line.find_first_of(kBlanks));
  line.remove_prefix(field.size());
  return field;
}

std::string_view trimmed(std::string_view text) {
  text.remove_prefix(std::min(text.find_first_not_of(kBlanks), text.size()));
  return text.substr(0, text.find_last_not_of(kBlanks) + 1);
}

// Each line that is neither empty nor a comment, without what ends it.
template <typename Take>
void forEachLine(std::istream& in, Take&& take) {
  bool first = true;
  for (std::string line; std::getline(in, line); first = false) {
    std::string_view text = line;
    if (first && text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);  // a byte order mark
    text = trimmed(text);
    if (!text.empty() && text.front() != '#') take(text);
  }
}

template <typename Entry>
void putInOrder(StampedList<Entry>& list) {
  const auto earlier = [](const Entry& a, const Entry& b) { return a.time < b.time; };
  std::ranges::stable_sort(list.entries, earlier);
  const auto same = [](const Entry& a, const Entry& b) { return a.time == b.time; };
  const auto doubled = std::ranges::unique(list.entries, same);
  list.duplicates = static_cast<int>(doubled.size());
  list.entries.erase(doubled.begin(), doubled.end());
}

bool isPicture(const fs::path& file) {
  const std::string extension = file.extension().string();
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

}  // namespace

std::optional<Timestamp> parseSeconds(std::string_view text) {
  const auto seconds = parseNumber(text);
  if (!seconds || std::abs(*seconds) > 1e11) return std::nullopt;
  return Timestamp{std::llround(*seconds * 1e6)};
}

std::optional<StampedList<StampedFile>> readPictureList(const fs::path& folder, const std::string& kind) {
  StampedList<StampedFile> list;
  std::error_code error;
  if (fs::exists(folder / (kind + ".txt"), error)) {
    std::ifstream in(folder / (kind + ".txt"));
    if (!in) throw std::invalid_argument((folder / (kind + ".txt")).string() + ": cannot be read");
    forEachLine(in, [&](std::string_view line) {
      const auto time = parseSeconds(takeField(line));
      const std::string_view file = trimmed(line);
      if (time && !file.empty()) {
        list.entries.push_back({*time, folder / file});
      } else {
        ++list.bad_lines;
      }
    });
  } else if (fs::is_directory(folder / kind, error)) {
    std::vector<fs::path> files;
    for (const auto& entry : fs::directory_iterator(folder / kind)) {
      if (isPicture(entry.path())) files.push_back(entry.path());
    }
    std::ranges::sort(files);  // so that it does not matter how the folder lists them
    for (const fs::path& file : files) {
      if (const auto time = parseSeconds(file.stem().string())) {
        list.entries.push_back({*time, file});
      } else {
        ++list.bad_lines;
      }
    }
  } else {
    return std::nullopt;
  }
  putInOrder(list);
  return list;
}

StampedList<TimedPose> readPoseList(const fs::path& file) {
  std::ifstream in(file);
  if (!in) throw std::invalid_argument(file.string() + ": cannot be read");
  StampedList<TimedPose> list;
  forEachLine(in, [&](std::string_view line) {
    const auto time = parseSeconds(takeField(line));
    std::array<std::optional<double>, 7> v;
    for (auto& value : v) value = parseNumber(takeField(line));
    const bool whole = time && std::ranges::all_of(v, [](const auto& x) { return x.has_value(); });
    if (whole) {
      const TimedPose pose{*time, {*v[0], *v[1], *v[2]}, Eigen::Quaterniond(*v[6], *v[3], *v[4], *v[5])};
      if (pose.isSane()) {
        list.entries.push_back(pose);
        return;
      }
    }
    ++list.bad_lines;
  });
  putInOrder(list);
  return list;
}

}  // namespace shoal::world
