// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/recorded_place.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <stdexcept>
#include <system_error>
#include <utility>

#include "shoal/world/recording.h"

namespace shoal::world {
namespace {

namespace fs = std::filesystem;

std::optional<int> robotNumber(const std::string& name) {
  constexpr std::string_view kPrefix = "robot";
  if (!name.starts_with(kPrefix)) return std::nullopt;
  int number = -1;
  const char* end = name.data() + name.size();
  const auto [stop, error] = std::from_chars(name.data() + kPrefix.size(), end, number);
  return error == std::errc{} && stop == end && number >= 0 ? std::optional(number) : std::nullopt;
}

bool isOneRecording(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / "groundtruth.txt", error) || fs::exists(folder / "rgb.txt", error) ||
         fs::is_directory(folder / "rgb", error);
}

std::map<int, fs::path> robotFolders(const fs::path& folder) {
  std::map<int, fs::path> robots;
  std::error_code error;
  for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
    const auto number = robotNumber(entry->path().filename().string());
    std::error_code ignored;
    if (!number || !entry->is_directory(ignored)) continue;
    if (robots.contains(*number)) {
      throw std::invalid_argument(folder.string() + ": two folders are robot " + std::to_string(*number));
    }
    robots[*number] = entry->path();
  }
  return robots;
}

/// A frame to fly, and the mission time it is given.
struct Flown {
  const Recording* recording;
  const RecordedFrame* frame;
  Timestamp time;
};

class RecordedSource final : public ObservationSource {
 public:
  RecordedSource(std::vector<Flown> frames, double altitude_m, std::vector<std::string> left_out)
      : frames_(std::move(frames)), altitude_m_(altitude_m), left_out_(std::move(left_out)) {}

  std::optional<Observation> next() override {
    while (next_ < frames_.size()) {
      const Flown& flown = frames_[next_++];
      std::string trouble;
      auto seen = loadFrame(*flown.recording, *flown.frame, altitude_m_, trouble);
      if (!trouble.empty()) ++troubles_[trouble];
      if (!seen) continue;
      seen->number = delivered_++;
      seen->time = flown.time;
      return seen;
    }
    return std::nullopt;
  }

  std::optional<int32_t> numObservations() const override { return static_cast<int32_t>(frames_.size()); }

  std::string troubles() const override {
    std::string text;
    for (const std::string& what : left_out_) text += (text.empty() ? "" : ", ") + what;
    for (const auto& [what, count] : troubles_) {
      text += (text.empty() ? "" : ", ") + std::to_string(count) + " x " + what;
    }
    return text;
  }

 private:
  const std::vector<Flown> frames_;
  const double altitude_m_;
  const std::vector<std::string> left_out_;
  std::map<std::string, int> troubles_;
  size_t next_ = 0;
  int32_t delivered_ = 0;
};

double twoDigits(double value) {
  std::array<char, 32> text{};
  const auto end =
      std::to_chars(text.data(), text.data() + text.size(), value, std::chars_format::scientific, 1).ptr;
  double rounded = value;
  std::from_chars(text.data(), end, rounded);
  return rounded;
}

class RecordedPlace final : public Place {
 public:
  RecordedPlace(std::string name, std::vector<Recording> robots, uint64_t seed)
      : name_(std::move(name)), robots_(std::move(robots)), seed_(seed) {
    for (const Recording& robot : robots_) {
      if (!robot.labelled) continue;
      if (classes_.empty()) classes_ = robot.camera.classes;
      const auto same = [](const TruthClass& a, const TruthClass& b) {
        return a.id == b.id && a.name == b.name;
      };
      if (!std::ranges::equal(classes_, robot.camera.classes, same)) {
        throw std::invalid_argument((robot.folder / "camera.json").string() +
                                    ": \"classes\" must be those of the other robots");
      }
    }
  }

  const std::string& name() const override { return name_; }
  const std::vector<TruthClass>& classes() const override { return classes_; }
  int maxRobots() const override { return static_cast<int>(robots_.size()); }
  bool isRecorded() const override { return true; }

  SurveyOptions completed(SurveyOptions options) const override {
    check(options);
    int32_t most = 0;
    for (size_t r = 0; r < robots_.size(); ++r) {
      most = std::max(most, static_cast<int32_t>(usable(robots_[r], options).size()));
    }
    options.observations = options.observations == 0 ? most : std::min(options.observations, most);
    if (options.cell_size_m == 0.0) options.cell_size_m = usualCellSize(options);
    return options;
  }

  std::unique_ptr<ObservationSource> source(const SurveyOptions& options, int robot,
                                            bool single) const override {
    check(options);
    if (!single && (robot < 0 || robot >= options.num_robots)) {
      throw std::invalid_argument("robot must be in [0, " + std::to_string(options.num_robots) + "), got " +
                                  std::to_string(robot));
    }
    std::vector<Flown> flown;
    std::vector<std::string> left_out;
    Timestamp take_off;  // of the next robot, when one flies all
    for (int r = single ? 0 : robot; r < (single ? options.num_robots : robot + 1); ++r) {
      const Recording& recording = robots_[static_cast<size_t>(r)];
      const auto frames = usable(recording, options);
      const size_t wanted = options.observations == 0
                                ? frames.size()
                                : std::min(frames.size(), static_cast<size_t>(options.observations));
      for (size_t i = 0; i < wanted; ++i) {
        const RecordedFrame* frame = frames[i * frames.size() / wanted];
        flown.push_back({&recording, frame, {take_off.us + frame->time.us - frames[0]->time.us}});
      }
      if (!flown.empty()) take_off.us = flown.back().time.us + 1'000'000;
      left_out.insert(left_out.end(), recording.left_out.begin(), recording.left_out.end());
      if (const size_t without = recording.frames.size() - frames.size(); without > 0) {
        left_out.push_back(std::to_string(without) + " pictures without depth");
      }
    }
    auto recorded =
        std::make_unique<RecordedSource>(std::move(flown), options.altitude_m, std::move(left_out));
    return withSensors(std::move(recorded), options.sensors, robot, seed_);
  }

  std::optional<Extent> extent() const override { return std::nullopt; }
  std::optional<uint8_t> truthOfSquare(const Grid&, const CellIndex&) const override { return std::nullopt; }
  bool hasFlatTruth() const override { return false; }

 private:
  void check(const SurveyOptions& options) const {
    checkSensors(options.sensors);
    if (options.num_robots < 1 || options.num_robots > maxRobots()) {
      throw std::invalid_argument(name_ + " is a recording of " + std::to_string(maxRobots()) +
                                  (maxRobots() == 1 ? " robot" : " robots") + "; as many can fly, got " +
                                  std::to_string(options.num_robots));
    }
    if (options.observations < 0) {
      throw std::invalid_argument("observations must be >= 0 (0 = all), got " +
                                  std::to_string(options.observations));
    }
    if (!(options.altitude_m >= 0.0) || !std::isfinite(options.altitude_m) || !(options.cell_size_m >= 0.0)) {
      throw std::invalid_argument("altitude and cell size must be finite and >= 0 m");
    }
  }

  /// The frames that have a depth, or are given a flat floor.
  static std::vector<const RecordedFrame*> usable(const Recording& robot, const SurveyOptions& options) {
    std::vector<const RecordedFrame*> frames;
    for (const RecordedFrame& frame : robot.frames) {
      if (frame.depth || options.altitude_m > 0.0) frames.push_back(&frame);
    }
    if (frames.empty()) {
      throw std::invalid_argument(robot.folder.string() +
                                  ": has no depth pictures near its colour pictures in time; give the height "
                                  "of the camera above a flat floor instead: --altitude-m");
    }
    return frames;
  }

  /// 24 pixels at the median depth of some frames of every robot.
  double usualCellSize(const SurveyOptions& options) const {
    constexpr size_t kFramesPerRobot = 8;
    constexpr int kPixelStep = 7;
    std::vector<double> metres_per_pixel;
    for (const Recording& robot : robots_) {
      const auto frames = usable(robot, options);
      const size_t wanted = std::min(frames.size(), kFramesPerRobot);
      for (size_t i = 0; i < wanted; ++i) {
        std::string trouble;
        const auto seen = loadFrame(robot, *frames[i * frames.size() / wanted], options.altitude_m, trouble);
        if (!seen) continue;
        for (int v = 0; v < seen->depth_m.rows; v += kPixelStep) {
          for (int u = 0; u < seen->depth_m.cols; u += kPixelStep) {
            const float depth = seen->depth_m.at<float>(v, u);
            if (depth > 0) metres_per_pixel.push_back(depth / robot.camera.intrinsics.fx);
          }
        }
      }
    }
    if (metres_per_pixel.empty()) {
      throw std::invalid_argument(name_ +
                                  ": no depth in its frames to choose a cell size by; give --cell-size-m");
    }
    const auto middle = metres_per_pixel.begin() + std::ssize(metres_per_pixel) / 2;
    std::nth_element(metres_per_pixel.begin(), middle, metres_per_pixel.end());
    return twoDigits(24.0 * *middle);
  }

  const std::string name_;
  const std::vector<Recording> robots_;
  const uint64_t seed_;
  std::vector<TruthClass> classes_;
};

}  // namespace

bool isRecording(const fs::path& folder) {
  std::error_code error;
  if (!fs::is_directory(folder, error)) return false;
  if (isOneRecording(folder)) return true;
  const auto robots = robotFolders(folder);
  return std::ranges::any_of(robots, [](const auto& robot) { return isOneRecording(robot.second); });
}

std::unique_ptr<Place> openRecording(const fs::path& folder, uint64_t seed,
                                     const std::optional<Camera>& camera) {
  std::vector<Recording> robots;
  if (isOneRecording(folder)) {
    robots.push_back(readRecording(folder, camera));
  } else {
    for (const auto& [number, robot_folder] : robotFolders(folder)) {
      if (number != static_cast<int>(robots.size())) {
        throw std::invalid_argument(folder.string() + ": robot" + std::to_string(robots.size()) +
                                    " is missing; the folders must be robot0, robot1, ... without gaps");
      }
      robots.push_back(readRecording(robot_folder, camera));
    }
  }
  const fs::path whole = fs::absolute(folder / "x").lexically_normal().parent_path();
  return std::make_unique<RecordedPlace>(whole.filename().string(), std::move(robots), seed);
}

}  // namespace shoal::world
