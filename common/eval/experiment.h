// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/eval/match_quality.h"
#include "shoal/eval/team_learning.h"
#include "shoal/eval/team_words.h"
#include "shoal/matching/matcher.h"

namespace shoal::eval {

/// What is asked of one repeat of the paper's experiment (Jamieson et al. 2021, §V).
struct RepeatOptions {
  LearningOptions learning;  ///< with the seed of this repeat
  std::vector<matching::MatcherOptions> matchers;
  int32_t repeat = 0;  ///< 0, 1, ...: from which share on the single robot flies, which teams are drawn
  int32_t exchange_every = 25;  ///< images between two exchanges of the team that merges its models, 0 = none
  bool measure_bytes = false;   ///< what a robot sends is measured too
};

/// One robot alone and the team at n robots or n images: AMI by matcher, in the order of the options.
struct Point {
  int32_t at = 0;           ///< robots, or images per robot
  std::vector<double> ami;  ///< by matcher
  double single = 0;        ///< the robot that flew as many shares alone; 0 where that is not asked
};

/// What one repeat came to. All AMI unless said.
struct Repeat {
  std::vector<Score> newest, concatenated;      ///< the whole team by matcher, under both fusion rules
  std::vector<MatchQuality> matches;            ///< of the whole team's topics by matcher
  Score oracle;                                 ///< each topic given the class of most of its cells
  Score single;                                 ///< one robot that flew all shares
  Score merged;                                 ///< the team that merges its models; no cells when not asked
  double merged_sent = 0, merged_received = 0;  ///< its bytes of models per robot
  double purity = 0;                       ///< share of the cells whose topic has their class as majority
  double topics_bytes = 0, map_bytes = 0;  ///< sent per robot, when asked
  std::vector<Point> by_robots;            ///< random teams of 1 to all robots
  std::vector<Point> by_images;            ///< the whole team after a tenth of the images, two tenths, ...
  double seconds = 0;                      ///< of wall time
};

/// Runs one repeat on one thread. Deterministic but for `seconds`. Random teams grow by one robot at a time
/// in an order drawn from the repeat's seed, which is also the order that the sequential matcher meets them
/// in; the whole team is scored in the order of its numbers, as a launched mission is.
Repeat runRepeat(const TeamWords& words, const RepeatOptions& options);

/// What the robots of the team believe when all have landed and looked again.
std::vector<mapping::LocalBelief> flyTeam(const TeamWords& words, const LearningOptions& learning);

/// AMI by matcher of a team alone: for areas cut into more or fewer shares.
std::vector<Score> scoreTeam(const TeamWords& words, const LearningOptions& learning,
                             const std::vector<matching::MatcherOptions>& matchers);

void to_json(nlohmann::json& json, const Repeat& repeat);
/// @throws nlohmann::json::exception when something lacks.
void from_json(const nlohmann::json& json, Repeat& repeat);
void to_json(nlohmann::json& json, const MatchQuality& quality);
void from_json(const nlohmann::json& json, MatchQuality& quality);
void to_json(nlohmann::json& json, const Score& score);
void from_json(const nlohmann::json& json, Score& score);

/// The matchers of the paper's Table I, in its order, then ours.
std::vector<matching::MatcherOptions> tableMatchers();

/// "CLEAR, cosine .75": how a table names a matcher.
std::string nameOf(const matching::MatcherOptions& matcher);

}  // namespace shoal::eval
