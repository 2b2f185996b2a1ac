// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <set>
#include <vector>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/piece.h"

namespace shoal::robot_agent {

/// Pictures that somebody wants sharper. They are the only pieces that are made because they are wanted.
class SharperPictures {
 public:
  /// Wanted are at most so many pieces between two calls of made(); what is more is asked for again.
  static constexpr size_t kMostWanted = 256;

  /// @param key  of a piece that its robot has not made, as in fusion_node::nameOf().
  void want(uint64_t key) {
    if (wanted_.size() < kMostWanted) wanted_.insert(key);
  }

  /// The pieces of those wanted that are of the belief's examples, as far as the plain picture was said and
  /// the sharper one was not. Nothing is wanted any more after that.
  /// @param said  what the robot has said. Cost: O(1) when nothing is wanted, else wire::sharperPieces() of
  ///              every picture that is made.
  std::vector<mapping::Piece> made(const mapping::LocalBelief& belief, const mapping::BeliefStore& said,
                                   int32_t epoch);

 private:
  std::set<uint64_t> wanted_;
};

}  // namespace shoal::robot_agent
