// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/replay.h"

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <variant>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/picture_files.h"
#include "operator_console/log_check.h"
#include "operator_console/render.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/belief_files.h"
#include "shoal/mapping/library.h"
#include "shoal/mapping/map_files.h"
#include "shoal/mapping/surprises.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

std::vector<world::RobotId> robotsOf(const fusion_node::MissionState& state) {
  std::vector<world::RobotId> robots = state.beliefs().robots();
  std::erase(robots, mapping::kOperators);
  std::erase(robots, mapping::kLibrary);
  return robots;
}

// The same state and another map: the recording does not say how its nodes matched.
void addOtherMaps(const fusion_node::MissionState& state, std::vector<std::string>& lacking) {
  for (const auto& [node, heartbeat] : state.heartbeats()) {
    if (heartbeat.map_of_state != state.map().state_digest || heartbeat.map_digest == state.mapDigest()) {
      continue;
    }
    lacking.push_back(node +
                      " made another map of the same state: give the --matcher, --similarity and "
                      "--sigma that it had");
  }
}

}  // namespace

mapping::LocalBelief heardMap(const mapping::BeliefStore& beliefs, world::RobotId robot) {
  std::map<world::CellIndex, mapping::BelievedCell> cells;
  std::map<world::CellIndex, mapping::CertaintyCell> certainty;
  beliefs.visit([&](const mapping::Piece& piece) {
    if (piece.key.robot != robot) return;
    if (const auto* brick = std::get_if<mapping::BrickPart>(&piece.content)) {
      for (const mapping::BrickCell& c : brick->cells) cells[c.cell] = {c.cell, c.topic, c.seen, 0};
    } else if (const auto* part = std::get_if<mapping::CertaintyPart>(&piece.content)) {
      for (const mapping::CertaintyCell& c : part->cells) certainty[c.cell] = c;
    }
  });
  mapping::LocalBelief belief{.robot = robot, .version = {}, .groups = {}, .topics = {}, .cells = {}};
  for (auto& [index, cell] : cells) {
    if (const auto heard = certainty.find(index); heard != certainty.end()) {
      cell.certainty = static_cast<float>(heard->second.steps) / static_cast<float>(mapping::kCertaintySteps);
      cell.surprise = static_cast<float>(heard->second.surprise) / mapping::kSurpriseStepsPerUnit;
    }
    belief.cells.push_back(cell);
  }
  return belief;
}

Replay replay(const std::string& log, const std::string& out, const matching::MatcherOptions& matcher,
              const std::string& key_file) {
  if (std::filesystem::exists(out + "/summary.json")) {
    throw std::invalid_argument("--out " + out + " holds a finished mission; name another folder");
  }
  Replay replay{log, out, readRecording(log, matcher, {}, {}, key_file), {}, {}};
  const fusion_node::MissionState& state = replay.recorded.state;
  replay.lacking = lackingPieces(log, replay.recorded.mission, state.beliefs(), state.heartbeats(), key_file);
  for (const world::RobotId robot : robotsOf(state)) {
    if (!state.heartbeats().contains(world::name(robot))) {
      replay.lacking.push_back(world::name(robot) + ": its heartbeats, which say whether this is all");
    }
  }
  addOtherMaps(state, replay.lacking);

  const world::Grid grid(state.cellSize());
  const auto write = [&](const std::string& name, const std::string& content) {
    mapping::writeFileAtomically(out + "/" + name, content);
    replay.files.push_back(name);
  };
  write("global_map.csv", mapping::globalMapCsv(state.map(), grid));
  write("labels.csv", mapping::labelsCsv(state.map(), grid));
  write("surprise.csv", mapping::surprisesCsv(mapping::surprisesOf(state.map(), state.beliefs()), grid));
  const auto pictures = mapping::picturesOfLabels(state.map(), state.beliefs());
  write("global_map.png", encodePng(render(state.map(), grid,
                                           fmt::format("mission {}, {} labels", replay.recorded.mission,
                                                       state.map().labels.size()),
                                           {}, legendPictures(pictures))));
  for (const std::string& file : fusion_node::writeLabelPictures(out + "/pictures", pictures)) {
    replay.files.push_back("pictures/" + file);
  }
  for (const world::RobotId robot : robotsOf(state)) {
    const mapping::LocalBelief heard = heardMap(state.beliefs(), robot);
    write("robots/" + world::name(robot) + "/map.csv", mapping::beliefCsv(heard, grid));
    write("robots/" + world::name(robot) + "/surprise.csv", mapping::surpriseCsv(heard, grid));
    const std::string folder = "robots/" + world::name(robot) + "/pictures";
    for (const std::string& file :
         fusion_node::writeTopicPictures(out + "/" + folder, state.beliefs(), robot)) {
      replay.files.push_back(folder + "/" + file);
    }
  }
  return replay;
}

Json Replay::json() const {
  const fusion_node::MissionState& state = recorded.state;
  return {{"log", log},
          {"out", out},
          {"mission_id", recorded.mission},
          {"messages", recorded.messages},
          {"refused", recorded.refused},
          {"seals", recorded.seals.json()},
          {"cells", state.map().cells.size()},
          {"labels", state.map().labels.size()},
          {"digest",
           {{"state", fmt::format("{:016x}", state.beliefs().digest())},
            {"map", fmt::format("{:016x}", state.mapDigest())}}},
          {"files", files},
          {"whole", isWhole()},
          {"lacking", lacking}};
}

std::string Replay::text() const {
  const fusion_node::MissionState& state = recorded.state;
  std::string text =
      fmt::format("mission {}: {} messages ({} refused), {} robots, {} cells, {} labels, in {}\n",
                  recorded.mission, recorded.messages, recorded.refused, robotsOf(state).size(),
                  state.map().cells.size(), state.map().labels.size(), out);
  text += recorded.seals.text();
  if (isWhole()) return text + "the recording holds all that the robots said they had\n";
  text += "the recording lacks\n";
  for (const std::string& line : lacking) text += "  " + line + "\n";
  return text;
}

}  // namespace shoal::console
