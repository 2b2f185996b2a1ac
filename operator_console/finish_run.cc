// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/finish_run.h"

#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/mission_state.h"
#include "operator_console/evaluate.h"
#include "operator_console/label_pictures.h"
#include "operator_console/render.h"
#include "shoal/comms/packet.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/map_files.h"
#include "shoal/mapping/queries.h"
#include "shoal/version.h"
#include "shoal/world/ids.h"
#include "shoal/world/place.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

Json bytesByClass(const RunInfo& run) {
  Json bytes = Json::object();
  for (const auto& [node, heartbeat] : run.last_heartbeats) {
    // Of what nodes do to repair the state, a heartbeat holds the sum alone: the rest of all bytes.
    int64_t rest = heartbeat.bytes_sent;
    for (size_t i = 0; i < wire::Heartbeat::kNumClasses; ++i) {
      bytes[node][std::string(comms::kTrafficClassNames[i])] = heartbeat.class_bytes[i];
      if (static_cast<comms::TrafficClass>(i) != comms::TrafficClass::kLocal)
        rest -= heartbeat.class_bytes[i];
    }
    bytes[node]["repair"] = std::max<int64_t>(rest, 0);
  }
  return bytes;
}

Json nodesOf(const RunInfo& run) {
  Json nodes = Json::array();
  const auto fusing = run.last_heartbeats.find("OPERATOR");
  for (const auto& [node, heartbeat] : run.last_heartbeats) {
    bool heard_whole = false;
    if (fusing != run.last_heartbeats.end()) {
      for (const wire::Heartbeat::Share& share : fusing->second.roster) {
        heard_whole |=
            world::name(share.robot) == node && share.digest == wire::shareDigest(heartbeat.own_digest);
      }
    }
    nodes.push_back(mapping::toJson(
        fusion_node::statusOf(node, heartbeat, heard_whole, {run.state_digest, run.map_digest})));
  }
  return nodes;
}

}  // namespace

std::string finishRun(const RunInfo& run) {
  const LaunchOptions& options = run.options;
  const auto place = openPlace(options);
  const world::Grid grid(options.cell_size_m);
  const mapping::GlobalMap map = mapping::readGlobalMap(options.out, grid);
  const Evaluation evaluation = evaluateRun(options.out, *place, surveyOf(options), eval::allMatchers());
  const bool has_truth = !place->classes().empty();
  const std::string title = fmt::format("{}, {} robot{}, {} labels", place->name(), options.num_robots,
                                        options.num_robots == 1 ? "" : "s", map.labels.size());
  mapping::writeFileAtomically(
      options.out + "/global_map.png",
      encodePng(render(map, grid, title, has_truth ? std::optional(evaluation.truth) : std::nullopt,
                       legendPictures(picturesOfRun(options.out)))));
  Json robots = Json::array();
  for (int number = 0; number < options.num_robots; ++number) {
    robots.push_back(world::name(world::RobotId{number}));
  }
  const comms::MeteredWindow& window = run.worst_window.window;
  Json summary = {
      {"seed", options.seed},
      {"mission_id", options.mission},
      {"commit", commit()},
      {"world", options.world},
      {"link", options.link},
      {"cell_size_m", options.cell_size_m},
      {"altitude_m", options.altitude_m},
      {"frame_period_s", options.frame_period_s},
      {"profile", options.profile},
      {"looks_again", options.looks_again},
      {"matching",
       {{"matcher", options.matcher.matcher},
        {"similarity", options.matcher.similarity},
        {"sigma", options.matcher.leastSimilarity()}}},
      {"sensors",
       {{"exposure", options.sensors.exposure},
        {"color_cast", options.sensors.color_cast},
        {"pose_drift", options.sensors.pose_drift},
        {"depth_noise", options.sensors.depth_noise},
        {"depth_holes", options.sensors.depth_holes}}},
      {"camera", options.camera.empty() ? Json() : Json::parse(mapping::readFile(options.camera))},
      {"robots", robots},
      {"observations", options.observations},
      {"bytes", bytesByClass(run)},
      {"worst_window",
       {{"bytes", window.bytes},
        {"budget", options.budget},
        {"robot", run.worst_window.node},
        {"start_s", static_cast<double>(window.start_us) * 1e-6},
        {"length_s", static_cast<double>(window.length_us) * 1e-6},
        {"within_budget", window.within_budget}}},
      {"cells", map.cells.size()},
      {"labels", map.labels.size()},
      {"coverage", evaluation.coverage},
      {"converged", run.converged},
      {"converged_s", run.converged_s},
      {"digest",
       {{"state", fmt::format("{:016x}", run.state_digest)},
        {"map", fmt::format("{:016x}", run.map_digest)}}},
      {"scores", has_truth ? evaluation.json() : Json::object()},
      {"nodes", nodesOf(run)},
  };
  mapping::writeFileAtomically(options.out + "/summary.json", summary.dump(2) + "\n");
  return has_truth ? scoreTable(evaluation) : "";
}

}  // namespace shoal::console
