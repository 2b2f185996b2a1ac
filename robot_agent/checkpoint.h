// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "fusion_node/moment.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/piece.h"
#include "shoal/mapping/poses_file.h"
#include "shoal/wire/bytes.h"
#include "shoal/world/ids.h"

namespace shoal::robot_agent {

/// What a robot needs to go on after a crash as if there had been none: its mind, and what it has told the
/// others, so that no version ever has two contents. Of one moment: what was said later either will be said
/// again the same way, or waits until this is written.
struct Checkpoint {
  int32_t mission = 0;
  world::RobotId robot{};
  int32_t epoch = 0;
  int64_t mission_us = 0;     ///< its clock ...
  fusion_node::Moment saved;  ///< ... at this moment
  mapping::Detail detail{};   ///< of what was told
  struct Cut {
    int64_t budget = 0;   ///< bytes per second of mission time, 0 = unlimited
    int64_t trailer = 0;  ///< bytes that the bus adds to a datagram
  };
  Cut cut = {};                   ///< what pieces were cut into parts for
  std::vector<uint8_t> explorer;  ///< robot::Explorer::checkpoint()
  struct Said {
    mapping::Piece piece;
    bool waits = false;   ///< not sent yet
    wire::Bytes message;  ///< the piece encoded, to write it; may be empty
  };
  std::vector<Said> said;                               ///< the usable parts of the newest versions
  std::vector<mapping::BeliefChanges::Waiting> untold;  ///< what had changed and was not said yet
  std::optional<mapping::Brick> looked_until;           ///< where the look for what has changed had arrived
  std::set<mapping::Brick> seen;                        ///< bricks that were seen and whose turn had not come
  std::vector<mapping::StampedPose> path;               ///< one pose an observation
};

/// The file of a robot's checkpoint in a folder.
std::string checkpointPath(const std::string& folder, world::RobotId robot);

/// The file that says in which epoch a robot has spoken, so that one that lost its checkpoint begins another.
std::string epochPath(const std::string& folder, world::RobotId robot);

/// Nothing when there is no such file.
/// @throws std::runtime_error naming the file and what it holds, when that is no epoch; or that cannot be
/// read.
std::optional<int32_t> readEpoch(const std::string& path);

/// Writes it whole or not at all. One process at a time.
/// @throws std::runtime_error naming the file that cannot be written.
void writeCheckpoint(const std::string& path, const Checkpoint& checkpoint);

/// Removes what processes that were killed had begun to write.
void removeUnfinished(const std::string& path);

/// Nothing when there is no such file.
/// @throws std::runtime_error naming the file, when it is damaged or cannot be read.
std::optional<Checkpoint> readCheckpoint(const std::string& path);

}  // namespace shoal::robot_agent
