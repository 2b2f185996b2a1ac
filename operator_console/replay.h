// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/recorded_mission.h"
#include "shoal/mapping/local_belief.h"

namespace shoal::console {

/// The cells of one robot's map as they were heard: its topics and where it drew them, with certainties in
/// steps of 1/63, as they travel (0 where none was heard). Topics themselves, of which only rounded counts
/// travel, are left out.
mapping::LocalBelief heardMap(const mapping::BeliefStore& beliefs, world::RobotId robot);

/// A mission's files rebuilt from a recording.
struct Replay {
  std::string log, out;
  RecordedMission recorded;
  std::vector<std::string> files;    ///< written, relative to `out`
  std::vector<std::string> lacking;  ///< what the recording does not hold; a line each

  bool isWhole() const { return lacking.empty(); }
  nlohmann::ordered_json json() const;  ///< docs/schemas/replay.schema.json
  std::string text() const;
};

/// Rebuilds what OPERATOR would hold from the recording alone, and writes into `out`: global_map.csv,
/// labels.csv, global_map.png and of each robot robots/RNN/map.csv. The two tables are, byte for byte, those
/// of the mission, and so are the maps of robots but for their certainties. What does not travel is not
/// there: exact counts (topics.json), paths (poses.txt), the truth and the scores. Whatever lacks, what there
/// is is written.
/// @param key_file  as MessageLog().
/// @throws std::runtime_error when the recording cannot be read or a file not written; std::invalid_argument
///         when `out` holds a finished mission.
Replay replay(const std::string& log, const std::string& out, const matching::MatcherOptions& matcher,
              const std::string& key_file = {});

}  // namespace shoal::console
