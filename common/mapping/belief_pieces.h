// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/piece.h"

namespace shoal::mapping {

/// A belief as whole pieces (part 0 of 1), ascending by key, all stamped with the belief's version: one per
/// topic, one per brick of labels, one per brick of certainties.
std::vector<Piece> wholePieces(const LocalBelief& belief);

/// Turns a robot's successive beliefs into what changed. A piece's version is the observation at which its
/// content last changed, so resending changes nothing.
class BeliefChanges {
 public:
  /// Whole pieces whose content differs from the last belief, ascending by key. A topic that is gone comes as
  /// a retired piece (weight 0, no words). Beliefs must be of one robot with versions that grow.
  std::vector<Piece> update(const LocalBelief& belief);

 private:
  std::map<PieceKey, uint64_t> content_hash_;  // of the content alone, version left out
};

}  // namespace shoal::mapping
