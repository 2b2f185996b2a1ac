// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/mission_sources.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>

#include <spdlog/spdlog.h>

#include "fusion_node/query_server.h"
#include "operator_console/recorded_mission.h"
#include "operator_console/remains.h"
#include "shoal/eval/evaluation.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/csv.h"
#include "shoal/mapping/edit_question.h"
#include "shoal/mapping/edits_answer.h"
#include "shoal/mapping/edits_file.h"
#include "shoal/mapping/fusion.h"
#include "shoal/mapping/library.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/map_files.h"
#include "shoal/mapping/questions.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

uint64_t digestFrom(const Json& text) { return std::stoull(text.get<std::string>(), nullptr, 16); }

// A node hands its map over as the same CSV text that a run's folder holds.
mapping::MissionView viewOfNode(const std::string& state_dir) {
  const Json status = fusion_node::askNode(state_dir, {{"query", "status"}});
  const Json map = fusion_node::askNode(state_dir, {{"query", "map"}});
  mapping::MissionView view;
  view.mission = status.at("mission_id");
  view.cell_size_m = map.at("cell_size_m");
  view.state_digest = digestFrom(status.at("digest").at("state"));
  view.map_digest = digestFrom(status.at("digest").at("map"));
  for (const Json& node : status.at("nodes")) view.nodes.push_back(mapping::nodeFromJson(node));
  view.map = mapping::parseGlobalMap(map.at("global_map_csv"), map.at("labels_csv"),
                                     world::Grid(view.cell_size_m), state_dir);
  return view;
}

Json readSummary(const std::string& dir) {
  const std::string path = dir + "/summary.json";
  if (!std::filesystem::exists(path)) {
    const std::string ask = howToAsk(dir);
    throw std::runtime_error(dir + " is not a finished run: it has no summary.json" +
                             (ask.empty() ? "" : "; what is left of it answers: " + ask));
  }
  try {
    return Json::parse(mapping::readFile(path));
  } catch (const Json::exception& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace

std::string editsPathOf(const Where& where) {
  if (!where.run.empty()) return where.run + "/edits.json";
  const std::filesystem::path log = where.log;
  if (log.filename() == "mission.lcmlog") return log.parent_path() / "edits.json";  // as in a run
  return where.log + ".edits.json";
}

namespace {

// What the robots' own files add up to, and what was decided since.
mapping::BeliefStore storeOfRun(const std::string& dir, const world::Grid& grid,
                                const std::vector<mapping::Edit>& edits) {
  mapping::BeliefStore store;
  for (const mapping::LocalBelief& belief : eval::readRun(dir, grid).robots) {
    for (const mapping::Piece& piece : mapping::wholePieces(belief)) store.apply(piece);
  }
  const std::string library = dir + "/library.json";
  if (std::filesystem::exists(library)) {
    for (const mapping::Piece& piece :
         mapping::piecesOf(mapping::parseLibrary(mapping::readFile(library), library)))
      store.apply(piece);
  }
  for (const mapping::Edit& edit : edits) store.apply(mapping::pieceOf(edit));
  return store;
}

mapping::MissionView filesOfRun(const std::string& dir) {
  const Json summary = readSummary(dir);
  mapping::MissionView view;
  try {
    view.mission = summary.at("mission_id");
    view.cell_size_m = summary.at("cell_size_m");
    view.state_digest = digestFrom(summary.at("digest").at("state"));
    view.map_digest = digestFrom(summary.at("digest").at("map"));
    for (const Json& node : summary.at("nodes")) view.nodes.push_back(mapping::nodeFromJson(node));
  } catch (const Json::exception& error) {
    throw std::runtime_error(dir + "/summary.json: " + error.what());
  }
  view.map = mapping::readGlobalMap(dir, world::Grid(view.cell_size_m));
  return view;
}

}  // namespace

mapping::MissionView viewOfRun(const std::string& dir) {
  mapping::MissionView view = filesOfRun(dir);
  const Where where{.node = {}, .run = dir, .log = {}, .matcher = matching::usualMatcher()};
  const auto edits = mapping::readEdits(editsPathOf(where), view.mission);
  if (edits.empty() && !std::filesystem::exists(dir + "/library.json")) return view;
  const uint64_t of_state = view.map.state_digest;
  view.map = mapping::fuse(storeOfRun(dir, world::Grid(view.cell_size_m), edits), matcherOf(where));
  view.map.state_digest = of_state;
  view.map_digest = view.map.digest();
  return view;
}

mapping::ToldSurprises surprisesOfRun(const std::string& dir, const world::Grid& grid) {
  mapping::ToldSurprises told;
  std::error_code none;
  for (const auto& entry : std::filesystem::directory_iterator(dir + "/robots", none)) {
    const auto robot = world::parseRobotId(entry.path().filename().string());
    const std::string path = entry.path().string() + "/surprise.csv";
    if (!robot || !std::filesystem::exists(path)) continue;
    for (const auto& row :
         mapping::parseCsv(mapping::readFile(path), {"x_m", "y_m", "z_m", "surprise"}, path)) {
      const uint8_t steps = mapping::surpriseSteps(static_cast<float>(mapping::toReal(row[3], path)));
      const Eigen::Vector3d at{mapping::toReal(row[0], path), mapping::toReal(row[1], path),
                               mapping::toReal(row[2], path)};
      if (steps > 0) told.tell(*robot, grid.cellOf(at), steps);
    }
  }
  return told;
}

namespace {

// Makes an edit and adds it to the file. Every answer from now on has it.
Json editInFile(const Where& where, const mapping::MissionView& view, mapping::BeliefStore& beliefs,
                const mapping::GlobalMap& map, const Json& question) {
  const std::string path = editsPathOf(where);
  std::vector<mapping::Edit> edits = mapping::readEdits(path, view.mission);
  world::Timestamp now;
  for (const mapping::NodeStatus& node : view.nodes)
    now.us = std::max<int64_t>(now.us, std::llround(node.heard_s * 1e6));
  const mapping::Edit edit = mapping::makeEdit(map, beliefs, question, "CONSOLE", now);
  edits.push_back(edit);
  mapping::writeFileAtomically(path, mapping::editsJson(view.mission, edits));
  beliefs.apply(mapping::pieceOf(edit));
  return mapping::editAnswer(edit, beliefs);
}

bool showSameLabels(const mapping::GlobalMap& a, const mapping::GlobalMap& b) {
  return std::ranges::equal(a.cells, b.cells, [](const mapping::GlobalCell& x, const mapping::GlobalCell& y) {
    return x.cell == y.cell && x.label == y.label && x.robot == y.robot;
  });
}

Json askRun(const Where& where, const Json& question) {
  mapping::MissionView view = viewOfRun(where.run);
  mapping::Witness witness{.view = view, .beliefs = {}, .matcher = matcherOf(where)};
  std::optional<mapping::BeliefStore> store;  // from the robots' own files, when it is needed
  witness.beliefs = [&]() -> const mapping::BeliefStore& {
    if (store) return *store;
    store = storeOfRun(where.run, world::Grid(view.cell_size_m),
                       mapping::readEdits(editsPathOf(where), view.mission));
    const mapping::GlobalMap again = mapping::fuse(*store, witness.matcher);
    if (!showSameLabels(again, view.map)) {
      spdlog::warn("{}: the robots' own files, matched with {}, do not give the labels of global_map.csv",
                   where.run, witness.matcher.matcher);
    }
    view.map.correspondences = again.correspondences;  // the files of a map do not hold them
    return *store;
  };
  const std::string recording = where.run + "/mission.lcmlog";
  if (std::filesystem::exists(recording)) {
    witness.events = [&] { return readRecording(recording, witness.matcher).state.events(); };
  }
  if (!mapping::isEdit(question)) return mapping::answer(witness, question);
  witness.beliefs();
  return editInFile(where, view, *store, view.map, question);
}

// A recording, and what was decided since.
RecordedMission recordingWithEdits(const Where& where) {
  RecordedMission recorded = readRecording(where.log, where.matcher, {}, {}, where.key);
  warnOfSeals(where.log, recorded.seals);
  for (const mapping::Edit& edit : mapping::readEdits(editsPathOf(where), recorded.mission)) {
    recorded.state.apply(mapping::pieceOf(edit));
  }
  recorded.state.refreshMap();
  return recorded;
}

matching::MatcherOptions optionsFrom(const Json& said) {
  matching::MatcherOptions options;
  said.at("matcher").get_to(options.matcher);
  said.at("similarity").get_to(options.similarity);
  if (!said.at("sigma").is_null()) options.sigma = said.at("sigma").get<double>();
  return options;
}

matching::MatcherOptions matcherOfNode(const Where& where) {
  const Json answer = fusion_node::askNode(where.node, {{"query", "matching"}});
  try {
    return optionsFrom(answer);
  } catch (const Json::exception&) {
    return where.matcher;  // a node of an older build
  }
}

}  // namespace

matching::MatcherOptions matcherOf(const Where& where) {
  if (!where.node.empty()) return matcherOfNode(where);
  if (where.run.empty()) return where.matcher;
  const Json summary = readSummary(where.run);
  const auto said = summary.find("matching");
  if (said == summary.end()) return where.matcher;  // a run of an older build
  try {
    return optionsFrom(*said);
  } catch (const Json::exception& error) {
    throw std::runtime_error(where.run + "/summary.json: " + error.what());
  }
}

namespace {

// What a node keeps of the mission that it heard last.
std::string newestMissionFile(const std::string& state_dir) {
  namespace fs = std::filesystem;
  std::error_code error;
  std::vector<std::pair<fs::file_time_type, std::string>> files;
  for (const auto& entry : fs::directory_iterator(state_dir, error)) {
    const std::string name = entry.path().filename();
    if (!name.starts_with("mission-") || !name.ends_with(".sqlite")) continue;
    fs::file_time_type newest = entry.last_write_time();
    const fs::path ahead = entry.path().string() + "-wal";
    if (fs::exists(ahead)) newest = std::max(newest, fs::last_write_time(ahead));
    files.emplace_back(newest, entry.path());
  }
  if (files.empty()) throw std::runtime_error(state_dir + " holds no mission that a node has heard");
  return std::ranges::max(files).second;
}

}  // namespace

std::string recordingOf(const Where& where) {
  if (!where.log.empty()) return where.log;
  if (!where.node.empty()) return newestMissionFile(where.node);
  std::string path = where.run + "/mission.lcmlog";
  if (!std::filesystem::exists(path)) {
    throw std::runtime_error(path + " is missing: only a mission flown with --record has a history");
  }
  return path;
}

mapping::MissionView viewOf(const Where& where) {
  if (!where.node.empty()) return viewOfNode(where.node);
  if (!where.run.empty()) return viewOfRun(where.run);
  return recordingWithEdits(where).state.view();
}

namespace {

Json askFiles(const Where& where, const Json& question) {
  if (!where.run.empty()) return askRun(where, question);
  const RecordedMission recorded = recordingWithEdits(where);
  const mapping::MissionView view = recorded.state.view();
  if (mapping::isEdit(question)) {
    mapping::BeliefStore beliefs = recorded.state.beliefs();
    return editInFile(where, view, beliefs, view.map, question);
  }
  const auto beliefs = [&]() -> const mapping::BeliefStore& { return recorded.state.beliefs(); };
  return mapping::answer({view, beliefs, where.matcher, [&] { return recorded.state.events(); }}, question);
}

}  // namespace

Json ask(const Where& where, const Json& question) {
  if (!where.node.empty()) return fusion_node::askNode(where.node, question);
  try {
    return askFiles(where, question);
  } catch (const std::invalid_argument& error) {
    if (!mapping::isEdit(question)) throw;
    return {{"error", error.what()}};  // as a node says it
  }
}

}  // namespace shoal::console
