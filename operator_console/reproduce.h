// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shoal/eval/experiment.h"

namespace shoal::console {

/// What `operator_console reproduce` is asked for.
struct ReproduceOptions {
  std::vector<std::string> worlds = {"reef:sparse", "reef:varied"};
  std::string out;
  std::string profile = "paper";
  int num_robots = 12;
  int32_t observations = 250;  ///< per robot
  int repeats = 24;
  int share_repeats = 4;  ///< of each cut of the area, at most `repeats`
  std::vector<int> shares = {2, 6, 12, 24, 48};
  int32_t exchange_every = 25;  ///< 0 = no team that merges its models
  uint64_t seed = 1;
  double cell_size_m = 0, altitude_m = 0;  ///< 0 = the world's default
};

/// AMI of a team on an area cut into `shares`, by matcher, a row a repeat.
struct SharesResult {
  int shares = 0;
  std::vector<std::vector<double>> ami;
};

/// A map beside its truth.
struct SampleMap {
  std::string name;
  std::string png;  ///< bytes
};

/// All that was found out about one world.
struct WorldResult {
  std::string world;
  int classes = 0;
  int robots = 0;
  int64_t images = 0;
  double cell_size_m = 0;
  std::vector<eval::Repeat> repeats;
  std::vector<SharesResult> by_shares;
  std::vector<SampleMap> maps;
  double seconds = 0;  ///< of wall time, what was kept from an earlier run not counted
};

/// Can robots of the profile learn from each other's models, as the team that merges its models does?
/// @throws std::invalid_argument for a profile that does not exist.
bool canMergeModels(const std::string& profile);

struct Reproduction {
  ReproduceOptions options;
  std::vector<matching::MatcherOptions> matchers;
  std::vector<WorldResult> worlds;
};

/// Runs the paper's experiments on all cores and writes report.html, table.csv, by_robots.csv, by_images.csv,
/// by_shares.csv and summary.json into `out`. What an interrupted run has finished is kept there and not done
/// again when options and program are the same. Progress goes to stderr.
/// @throws std::invalid_argument naming the option that is wrong; std::runtime_error when files cannot be
/// written
///         or a signal asks to stop.
Reproduction reproduce(const ReproduceOptions& options);

/// Table I of the paper with its figures beside ours, as text.
std::string tableOf(const Reproduction& reproduction);

}  // namespace shoal::console
