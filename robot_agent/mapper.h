// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <vector>

#include "robot_agent/checkpoint.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/piece.h"
#include "shoal/mapping/poses_file.h"
#include "shoal/robot/explorer.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/picture_pieces.h"
#include "shoal/world/observation.h"

namespace shoal::robot_agent {

/// What one robot has flown and learnt, and what of it nobody has been told yet.
///
/// Topics change with every image, bricks with every image that shows them, and both are dear to encode and
/// to send: each is told in one of so many images, and at the end. Counts, so that what is told does not
/// depend on how fast the robot flew, and in turns, so that no image takes long.
class Mapper {
 public:
  static constexpr size_t kTurns = 5;

  /// @throws as robot::Explorer().
  explicit Mapper(const robot::ExplorerOptions& options) : explorer_(options) {
    belief_.robot = options.robot;
  }

  /// Learns from one image. @returns the CPU that it took.
  robot::StageTimes learn(const world::Observation& observation);

  /// Judges every cell anew by what the team knows: robot::Explorer::lookAgain().
  /// @param breathe  called now and then meanwhile; sees the belief from before.
  void lookAgain(const topics::TeamTopics& team, const std::function<void()>& breathe);

  /// Topics, bricks and certainties that are found to have changed and have their turn, whole.
  std::vector<mapping::Piece> changesInTurn();
  /// All that have changed. Takes longer the larger the map is.
  std::vector<mapping::Piece> allChanges();
  /// The layers of pictures that have changed.
  std::vector<mapping::Piece> changedPictures() { return picture_changes_.update(belief_); }

  const robot::Explorer& explorer() const { return explorer_; }
  /// As of the last image; has its cells only once allChanges() was called since.
  const mapping::LocalBelief& belief() const { return belief_; }
  /// One pose an observation.
  const std::vector<mapping::StampedPose>& path() const { return path_; }

  /// Fills in what was learnt and what was not told.
  void saveTo(Checkpoint& checkpoint) const;
  /// As it was then. @throws as robot::Explorer::restore().
  void restore(const Checkpoint& checkpoint);

  /// Fills in what the heartbeat says of this.
  void report(wire::Heartbeat& heartbeat) const;

 private:
  robot::Explorer explorer_;
  mapping::LocalBelief belief_;
  std::vector<mapping::StampedPose> path_;
  mapping::BeliefChanges changes_;
  wire::PictureChanges picture_changes_;
};

}  // namespace shoal::robot_agent
