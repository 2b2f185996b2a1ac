// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include "shoal/mapping/piece.h"
#include "shoal/wire/heartbeat_codec.h"

namespace shoal::console {

/// Which parts of which pieces were heard, to name those that were not.
class PieceAudit {
 public:
  void hear(const mapping::Piece& piece);

  /// What lacks of a robot's share of the state, as far as it can be told: parts of the newest version of a
  /// piece, labels of a brick whose certainties were heard and the reverse, and how many topics and cells
  /// its last heartbeat counts above those that were heard. A piece of which nothing newer than an old
  /// version was heard has no name here; when there is nothing else, one line says that. Never empty.
  std::vector<std::string> lacking(world::RobotId robot, const wire::Heartbeat& last) const;

 private:
  struct Heard {
    world::Version version;  // the newest
    int32_t num_parts = 1;
    std::map<int32_t, int64_t> cells;  // or topics that are not retired: by part
  };
  std::map<mapping::PieceKey, Heard> pieces_;
  std::map<world::RobotId, int32_t> epochs_;  // the newest heard of
};

}  // namespace shoal::console
