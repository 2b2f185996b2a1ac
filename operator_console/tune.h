// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace shoal::console {

/// What `operator_console tune` is asked for.
struct TuneOptions {
  std::string world = "reef:tuning";
  std::string out;
  std::string profile = "paper";
  std::vector<std::string> knobs;  ///< empty: alpha and beta, or evidence and beta for "best"
  std::string score = "alone";     ///< "alone": one robot's AMI; "team": the fused map's, CLEAR cosine .75
  int num_robots = 4;              ///< shares; the robot that flies alone flies all of them
  int32_t observations = 60;       ///< per share
  int seeds = 3;                   ///< a setting's score is the mean over so many
  int random = 20;                 ///< settings drawn at random before the guided ones
  int trials = 60;                 ///< settings in all
  uint64_t seed = 1;
};

/// Searches hyper-parameters by AMI. Every setting tried is kept in OUT/trials.json as soon as it is scored;
/// the same command goes on from there. Writes OUT/best.json. Progress goes to stderr.
/// @returns what best.json holds.
/// @throws std::invalid_argument naming the option that is wrong.
nlohmann::ordered_json tune(TuneOptions options);

}  // namespace shoal::console
