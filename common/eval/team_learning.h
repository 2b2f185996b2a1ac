// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shoal/eval/team_words.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/matching/descriptors.h"
#include "shoal/matching/matcher.h"
#include "shoal/topics/make_learner.h"

namespace shoal::eval {

struct TeamTally;

/// How robots learn from words in an experiment: as robot_agent does, in this process.
struct LearningOptions {
  std::string profile = "paper";
  uint64_t seed = 1;                                              ///< mission seed
  std::optional<topics::LearnerHyperparameters> hyperparameters;  ///< other than the profile's
  bool looks_again = true;  ///< robots that can look again at their maps when the team has landed
};

/// What one robot believes after `checkpoints[i]` images (ascending; more than there are = all), one belief a
/// checkpoint. The last one equals the map.csv and topics.json of the robot_agent that flew the same images
/// and did not look again.
/// @param mind  Out, unless null: Explorer::checkpoint() after the last.
std::vector<mapping::LocalBelief> learn(const std::vector<world::WordsInCells>& images, world::RobotId robot,
                                        double cell_size_m, const LearningOptions& options,
                                        std::span<const int32_t> checkpoints,
                                        std::vector<uint8_t>* mind = nullptr);

/// A robot that has landed: what it believes, and its mind.
struct Landed {
  mapping::LocalBelief belief;
  std::vector<uint8_t> mind;
};

/// What the robots of a team believe when they have looked again at their maps, as robot_agent does; what
/// they believed before with a profile that does not, or when not asked to.
std::vector<mapping::LocalBelief> lookAgain(std::span<const Landed* const> team, double cell_size_m,
                                            const LearningOptions& options);

/// What a robot sends in a mission without losses: the changes of its belief after every fifth image and the
/// last, all at once, where robot_agent tells a fifth of them with every image.
struct SentBytes {
  int64_t topics = 0, map = 0;  ///< bytes on the wire, all headers counted; map = labels and certainties
  int64_t datagrams = 0;
};
SentBytes bytesSent(const std::vector<world::WordsInCells>& images, world::RobotId robot, double cell_size_m,
                    const LearningOptions& options);

/// Topics in the order of `team`, as a fusion node that has heard all of them stacks them: `team[i]` is taken
/// to be robot i. Only topics that label cells.
struct Stacked {
  matching::DescriptorSet descriptors;
  std::vector<mapping::LocalBelief> beliefs;  ///< the team, numbered from 0
};
Stacked stackTeam(std::vector<mapping::LocalBelief> team);

/// The label that a matcher gives each topic of a tally, which was taken from stackTeam().beliefs.
std::vector<int> labelsOf(const Stacked& team, const TeamTally& tally,
                          const matching::MatcherOptions& matcher);

/// Scores one matcher on a team whose tally was taken from stackTeam().beliefs.
Score scoreMatcher(const Stacked& team, const TeamTally& tally, const matching::MatcherOptions& matcher);

}  // namespace shoal::eval
