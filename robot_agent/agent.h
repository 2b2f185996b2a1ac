// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "fusion_node/mission_state.h"
#include "fusion_node/repair.h"
#include "fusion_node/silence_alarm.h"
#include "robot_agent/background_save.h"
#include "robot_agent/checkpoint.h"
#include "shoal/comms/bus.h"
#include "shoal/comms/mission_clock.h"
#include "shoal/comms/sender.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/poses_file.h"
#include "shoal/robot/explorer.h"
#include "shoal/wire/picture_pieces.h"
#include "shoal/wire/piece_codec.h"
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
  std::function<void(const ImageTimes&)> watch;  ///< told after each image, to measure; may be empty
};

/// One robot: flies its source, learns, tells the others under its budget, and listens. When all of the team
/// have landed it looks at its map again, by what the team knows (robot/team_topics.h), and tells what it now
/// takes for something else: so what it tells in the end is a function of what all have learnt, whenever it
/// heard of it.
class Agent {
 public:
  /// `source` and `bus` outlive the agent.
  Agent(const AgentOptions& options, world::ObservationSource& source, comms::Bus& bus);

  /// Flies the source to its end, then keeps telling until a fusion node holds all it had to say (or, with
  /// `linger`, until a stop is requested). A stop request ends it early; what was learnt is written all the
  /// same.
  /// @throws std::runtime_error when the output cannot be written.
  void run();

 private:
  void fly();
  void awaitTeam();
  bool willLookAgain() const {
    return options_.looks_again && explorer_.canLookAgain() && !explorer_.hasLookedAgain() && !path_.empty();
  }
  void lookAgain();
  void awaitObservation();
  void linger();
  void resume();
  void save();
  void lookAtSave(bool waits);
  void awaitSaved();
  Checkpoint snapshot();
  void takeIn(const world::Observation& observation);
  void publish();
  void publishAll();
  void publish(const std::vector<mapping::Piece>& changed);
  void publishPictures();
  void forget(const std::string& key);
  void say(const mapping::Piece& part);
  void say(const mapping::Piece& part, wire::Bytes message);
  void sayWhenSaved(const mapping::Piece& part, wire::Bytes message);
  bool isHolding() const { return !unsaid_.empty() || !being_saved_.empty(); }
  void offer(const mapping::Piece& part, wire::Bytes message);
  void sharpenWanted();
  void passTimeUntil(int64_t to_us);
  void passSecond();
  void listen(int timeout_ms);
  void breathe();
  bool isHeard() const;
  std::optional<comms::Packet> join(std::span<const comms::SendQueue::Next> together) const;
  void write();
  comms::Packet heartbeat(int64_t now_us);

  AgentOptions options_;
  std::string name_;
  world::ObservationSource& source_;
  comms::Bus& bus_;
  robot::Explorer explorer_;
  mapping::BeliefChanges changes_;
  wire::PictureChanges picture_changes_;
  std::set<uint64_t> wanted_;                       // keys of pieces of ours that nobody has made yet
  mapping::LocalBelief belief_;                     // in flight without its cells
  mapping::BeliefStore own_;                        // what was said, for its digest
  std::map<mapping::PieceKey, int32_t> num_parts_;  // keys in the send queue
  std::map<std::string, mapping::Piece, std::less<>> said_;  // by its keys
  // What could not be said again the same way after a crash, and so waits until a checkpoint has it: for one
  // to be begun, and to be done. By its keys.
  std::map<std::string, wire::EncodedPart> unsaid_, being_saved_;
  BackgroundSave saving_;
  fusion_node::MissionState others_;
  comms::MissionClock clock_;
  comms::Sender sender_;
  fusion_node::Repair repair_;
  std::vector<mapping::StampedPose> path_;
  wire::Phase phase_ = wire::Phase::kFlying;
  double total_ms_ = 0;
  std::chrono::steady_clock::time_point breathed_;
  fusion_node::SilenceAlarm silence_;
  bool warned_of_twin_ = false;
  bool epoch_is_kept_ = false;
  size_t warned_of_missions_ = 0;
};

/// One robot that explores alone and tells nobody: the paper's comparator.
void runAlone(const AgentOptions& options, world::ObservationSource& source);

}  // namespace shoal::robot_agent
