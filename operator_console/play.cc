// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/play.h"

#include <algorithm>
#include <chrono>
#include <functional>
#include <stdexcept>
#include <thread>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "operator_console/stop_signal.h"
#include "shoal/comms/camera_channels.h"
#include "shoal/comms/mission_clock.h"
#include "shoal/wire/camera_pixels.h"
#include "shoal/world/stamped_files.h"

namespace shoal::console {
namespace {

namespace fs = std::filesystem;

struct Said {
  world::Timestamp time;
  int order = 0;  // of what is said at one time
  std::function<void()> say;
};

cv::Mat readPicture(const fs::path& file, int flags, int type) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return {};
  const cv::Mat picture = cv::imread(file.string(), flags | cv::IMREAD_IGNORE_ORIENTATION);
  return picture.type() == type ? picture : cv::Mat();
}

// Receivers' sockets hold little: half a millisecond for every datagram that LCM cuts a message into.
void leaveTimeFor(size_t bytes) {
  std::this_thread::sleep_for(std::chrono::microseconds(500) * (1 + static_cast<int64_t>(bytes / 65'000)));
}

}  // namespace

Played play(const fs::path& folder, const std::string& prefix, double rate, comms::Bus& bus) {
  const comms::CameraChannels channels(prefix);
  const auto colors = world::readPictureList(folder, "rgb"), depths = world::readPictureList(folder, "depth");
  if (!colors)
    throw std::invalid_argument(folder.string() + ": has neither rgb.txt nor a folder rgb; " +
                                "play one robot's RGB-D folder");
  const auto poses = world::readPoseList(folder / "groundtruth.txt");
  Played played;
  const auto publish = [&](const std::string& channel, wire::Bytes bytes) {
    const size_t size = bytes.size();
    bus.publish({channel, std::move(bytes)});
    leaveTimeFor(size);
  };
  const auto publishPicture = [&](const std::string& channel, const cv::Mat& picture, world::Timestamp time,
                                  int64_t& count) {
    ++(picture.empty() ? played.unreadable : count);
    if (!picture.empty()) publish(channel, wire::encode(wire::viewOf(picture, time)));
  };
  std::vector<Said> said;
  for (const world::TimedPose& pose : poses.entries) {
    said.push_back({pose.time, 0, [&] {
                      publish(channels.pose, wire::encode(pose));
                      ++played.poses;
                    }});
  }
  if (depths) {
    for (const world::StampedFile& depth : depths->entries) {
      said.push_back({depth.time, 1, [&] {
                        publishPicture(channels.depth,
                                       readPicture(depth.file, cv::IMREAD_UNCHANGED, CV_16UC1), depth.time,
                                       played.depths);
                      }});
    }
  }
  for (const world::StampedFile& color : colors->entries) {
    said.push_back({color.time, 2, [&] {
                      publishPicture(channels.image, readPicture(color.file, cv::IMREAD_COLOR, CV_8UC3),
                                     color.time, played.images);
                    }});
  }
  if (said.empty()) return played;
  std::ranges::stable_sort(said, {}, [](const Said& s) { return std::pair(s.time, s.order); });
  if (said.front().time.us < 0) {
    throw std::invalid_argument(folder.string() + ": LCM's times do not begin before 0");
  }
  comms::MissionClock clock(rate, said.front().time.us);
  for (const Said& each : said) {
    while (stopSignal() == 0 && clock.now() < each.time.us) {
      clock.waitUntil(std::min(each.time.us, clock.now() + 100'000));
    }
    if (stopSignal() != 0) break;
    each.say();
  }
  return played;
}

}  // namespace shoal::console
