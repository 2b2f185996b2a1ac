// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/global_map.h"
#include "shoal/mapping/label_census.h"
#include "shoal/world/grid.h"

namespace shoal::mapping {

/// What is known of one process of a mission, as its last heartbeat told it.
struct NodeStatus {
  std::string name;              ///< "R03", "OPERATOR"
  std::string phase;             ///< "flying", "listening", "landed", "leaving", "node"
  double heard_s = 0;            ///< mission time of its last heartbeat
  int32_t observation = -1;      ///< its latest image, -1 = none yet
  int32_t num_observations = 0;  ///< of its whole stream, 0 = unknown
  int32_t topics = 0, cells = 0;
  int64_t bytes_sent = 0;   ///< on the link, headers counted, in all its lives that were heard
  int32_t budget = 0;       ///< bytes per second of mission time, 0 = unlimited
  int32_t queue_bytes = 0;  ///< waiting to be sent
  /// Seconds of mission time in which its budget lets it say what waits; 0 without a budget.
  double clear_s = 0;
  float ms_per_frame = 0;
  float x_m = 0, y_m = 0, z_m = 0;  ///< position of the camera, world
  int32_t rejected = 0, conflicts = 0;
  /// Seconds of mission time that its clock is ahead of the other robots' (behind: below 0), the least that
  /// fits what was heard; nothing when it is no robot or was heard alone.
  std::optional<double> clock_skew_s = {};
  /// What it learns with beside what most robots do: "same", "other words", "other hyper-parameters", "other
  /// cells", "unknown"; "none" when it is no robot.
  std::string settings = "none";
  /// Part of the bytes it sent in its last minute that arrived where the answer comes from, in [0, 1];
  /// nothing while that is not known.
  std::optional<double> heard_share = {};
  std::optional<int> battery_percent = {};  ///< in [0, 100], when its vehicle says so
  std::optional<double> depth_m = {};       ///< below the surface, >= 0, when its vehicle says so
  bool heard_whole = false;                 ///< the answering node holds all that this one has to say
  /// Its map beside that of who answers: "same"; "behind" when it was made from another state; "other" when
  /// the states are equal and the maps are not, which is an alarm; "none" when it does not fuse.
  std::string agreement = "none";
  /// `bytes_sent` by class of traffic; "repair" is what was asked for and said again. Empty: it is not known.
  std::map<std::string, int64_t> class_bytes = {};
};

/// Somebody who speaks on the mission's channels without its key.
struct StrangerStatus {
  std::string name;  ///< of the channel; anybody may use any
  std::string has;   ///< "no key", "other key", or "a key" when who answers has none
  uint64_t messages = 0;
};

/// What was heard together and does not belong together.
struct Mixture {
  std::string kind;  ///< "clock", "twin", "conflict", "mission", "settings"
  std::string node;  ///< whose; empty when it is not one node's
  std::string says;
};

/// A mission as one place knows it: a live node, a finished run or a recording. All questions are asked of
/// it.
struct MissionView {
  int64_t mission = 0;
  double cell_size_m = 1.0;
  GlobalMap map;
  uint64_t state_digest = 0, map_digest = 0;
  std::vector<NodeStatus> nodes;               ///< robots first, by number, then the others by name
  std::vector<StrangerStatus> strangers = {};  ///< by name
  std::vector<Mixture> mixed = {};             ///< by kind, then name
};

/// Answers as JSON objects; docs/operators.md shows one of each.
nlohmann::ordered_json statusAnswer(const MissionView& view);
/// The same of a view whose cells were left out, for they are many.
nlohmann::ordered_json statusAnswer(const MissionView& view, int64_t num_cells);
nlohmann::ordered_json labelsAnswer(const MissionView& view);
/// The rows of labelsAnswer(). @param census  of the map's cells.
nlohmann::ordered_json labelRows(const std::vector<LabelSummary>& labels, const LabelCensus& census,
                                 const world::Grid& grid);
/// A node as it stands in statusAnswer(), and back. @throws nlohmann::json::exception for a missing key.
nlohmann::ordered_json toJson(const NodeStatus& node);
NodeStatus nodeFromJson(const nlohmann::ordered_json& json);
/// Sixteen hexadecimal digits, as digests are shown everywhere.
std::string digestText(uint64_t digest);
/// Every cell of the column at (x, y), metres, world, from low to high, each with its history: how every
/// robot that told of it labels it and when it last saw it, newest first. No cells: an empty list.
/// @param beliefs  what the view's map was fused from.
nlohmann::ordered_json atAnswer(const MissionView& view, const BeliefStore& beliefs, double x_m, double y_m);

}  // namespace shoal::mapping
