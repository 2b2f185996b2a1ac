// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/robot_tracks.h"

#include <algorithm>
#include <filesystem>

#include "operator_console/recorded_mission.h"
#include "shoal/mapping/poses_file.h"

namespace shoal::console {
namespace {

using Tracks = std::map<std::string, std::vector<TrackPoint>>;

Tracks tracksOfRun(const std::string& dir) {
  Tracks tracks;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(dir + "/robots", none)) {
    const std::string name = entry.path().filename(), path = entry.path().string() + "/poses.txt";
    if (!world::parseRobotId(name) || !std::filesystem::exists(path)) continue;
    for (const mapping::StampedPose& pose : mapping::readPoses(path)) {
      const Eigen::Vector3d at = pose.world_from_camera.translation();
      tracks[name].push_back({pose.time.seconds(), at.x(), at.y(), at.z()});
    }
  }
  return tracks;
}

Tracks tracksOfRecording(const Where& where) {
  Tracks tracks;
  const auto on_message = [&tracks](const comms::ChannelName& channel, const wire::Header& header,
                                    const comms::Packet&, const fusion_node::MissionState& state) {
    if (header.kind != wire::MessageKind::kHeartbeat || !world::parseRobotId(channel.node)) return;
    const mapping::NodeStatus node =
        fusion_node::statusOf(channel.node, state.heartbeats().at(channel.node), false, {});
    if (node.observation >= 0) tracks[channel.node].push_back({node.heard_s, node.x_m, node.y_m, node.z_m});
  };
  readRecording(recordingOf(where), where.matcher, on_message, {}, where.key);
  return tracks;
}

}  // namespace

Tracks tracksOf(const Where& where) {
  Tracks tracks = where.run.empty() ? tracksOfRecording(where) : tracksOfRun(where.run);
  for (auto& [name, points] : tracks) {
    std::ranges::stable_sort(points, {}, &TrackPoint::time_s);
    const auto same = [](const TrackPoint& a, const TrackPoint& b) { return a.time_s == b.time_s; };
    points.erase(std::unique(points.begin(), points.end(), same), points.end());
  }
  std::erase_if(tracks, [](const auto& track) { return track.second.size() < 2; });
  return tracks;
}

}  // namespace shoal::console
