// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>

#include "fusion_node/mission_state.h"
#include "robot_agent/checkpoint.h"
#include "robot_agent/checkpoint_saver.h"
#include "robot_agent/listener.h"
#include "robot_agent/mapper.h"
#include "robot_agent/publisher.h"
#include "robot_agent/sharper_pictures.h"
#include "robot_agent/timekeeper.h"
#include "robot_agent/voice.h"
#include "shoal/comms/bus.h"
#include "shoal/comms/mission_clock.h"
#include "shoal/robot/explorer.h"
#include "shoal/world/source.h"

namespace shoal::robot_agent {

/// Milliseconds of CPU that an image took beside what the explorer did with it.
struct ImageTimes {
  robot::StageTimes stages;
  double publish_ms = 0;  ///< to find out what has changed and to encode it
  double save_ms = 0;     ///< to begin a checkpoint
  int32_t num_cells = 0;  ///< of the map by then
};

struct AgentOptions {
  robot::ExplorerOptions explorer;
  int32_t mission = 1;
  int64_t budget = 2000;  ///< bytes per second of mission time on the link, 0 = unlimited
  int64_t start_us = 0;   ///< mission time at which the flight begins: later after a restart
  double rate = 1.0;      ///< seconds of mission time per wall second, 0 = as fast as possible
  bool fuse = false;      ///< hold everybody's beliefs and fuse them too
  matching::MatcherOptions matcher = matching::usualMatcher();  ///< for `fuse` and to look again
  std::string out_dir;                                          ///< where robots/RNN/ goes; empty = nowhere
  int32_t team_size = 1;                         ///< robots to wait for after landing, heard or not
  bool looks_again = true;                       ///< at its map after landing, by what the team knows
  bool linger = false;                           ///< stay after landing until told to stop, heard or not
  std::string checkpoint_dir;                    ///< where checkpoints go; empty = nowhere
  std::optional<Checkpoint> resume;              ///< what to go on from, of this mission, robot and epoch
  bool live = false;                             ///< what the source has shown it will not show again
  bool has_mission_time = false;                 ///< a live source's times count from the mission's start
  std::function<void(const ImageTimes&)> watch;  ///< told after each image, to measure; may be empty
};

/// One robot: flies its source, learns, tells the others under its budget, and listens. When all of the team
/// have landed it looks at its map again, by what the team knows (robot/team_topics.h), and tells what it now
/// takes for something else: so what it tells in the end is a function of what all have learnt, whenever it
/// heard of it.
///
/// What it learns flows one way: source -> Mapper -> Publisher -> CheckpointSaver -> Voice -> bus. What
/// others say comes in by the Listener, while the Timekeeper lets time pass.
class Agent {
 public:
  /// `source` and `bus` outlive the agent.
  /// @throws std::invalid_argument when it was to go on in another detail than before.
  Agent(const AgentOptions& options, world::ObservationSource& source, comms::Bus& bus);

  /// Flies the source to its end, then keeps telling until a fusion node holds all it had to say (or, with
  /// `linger`, until a stop is requested). A stop request ends it early; what was learnt is written all the
  /// same.
  /// @throws std::runtime_error when the output cannot be written.
  void run();

 private:
  void fly();
  void takeIn(const world::Observation& observation);
  void awaitTeam();
  bool willLookAgain() const;
  void lookAgain();
  void linger();
  void write();

  bool isRepeatable() const { return !options_.live && !mapper_.explorer().hasLookedAgain(); }
  void publishAll();
  void sharpenWanted();
  void answer();

  void resume(const Checkpoint& checkpoint);
  Checkpoint snapshot();
  wire::Heartbeat heartbeat(int64_t now_us);

  const AgentOptions options_;
  world::ObservationSource& source_;
  comms::MissionClock clock_;
  fusion_node::MissionState state_;  // what all have said, as far as it was heard
  Mapper mapper_;
  SharperPictures sharper_;
  Voice voice_;
  CheckpointSaver saver_;
  Publisher publisher_;
  Listener listener_;
  Timekeeper time_;
  wire::Phase phase_ = wire::Phase::kFlying;
  double total_ms_ = 0;  // of wall time, that images took
};

}  // namespace shoal::robot_agent
