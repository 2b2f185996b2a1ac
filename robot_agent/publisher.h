// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "robot_agent/checkpoint_saver.h"
#include "robot_agent/voice.h"
#include "shoal/mapping/piece.h"

namespace shoal::robot_agent {

/// Says whole pieces in parts that fit into datagrams, and says no more the parts that a piece had before and
/// has no longer.
class Publisher {
 public:
  /// Both outlive it.
  Publisher(int32_t mission, CheckpointSaver& saver, const Voice& voice)
      : mission_(mission), saver_(saver), voice_(voice) {}

  /// Topics, bricks and certainties, whole. @param repeatable  as CheckpointSaver::say().
  void publish(const std::vector<mapping::Piece>& whole_pieces, bool repeatable);

  /// The layers of pictures, which fit as they are: wire/picture_pieces.h.
  void publishPictures(const std::vector<mapping::Piece>& layers, bool repeatable);

  /// As if all that had been published that was said by then.
  void restore(const Checkpoint& checkpoint);

 private:
  const int32_t mission_;
  CheckpointSaver& saver_;
  const Voice& voice_;
  std::map<mapping::PieceKey, int32_t> num_parts_;  // of what was published
};

}  // namespace shoal::robot_agent
