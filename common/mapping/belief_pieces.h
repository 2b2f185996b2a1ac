// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "shoal/mapping/believed_bricks.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/piece.h"

namespace shoal::mapping {

/// A belief as whole pieces (part 0 of 1), ascending by key, all stamped with the belief's version: one per
/// topic, one per brick of labels, one per brick of certainties.
std::vector<Piece> wholePieces(const LocalBelief& belief);

/// Turns a robot's successive beliefs into what changed. A piece's version is the observation at which its
/// content was last seen to have changed, so resending changes nothing.
class BeliefChanges {
 public:
  /// A brick that has changed and was not told yet.
  struct Waiting {
    PieceKey key;
    uint64_t told_hash = 0;  ///< of what was told of it last; 0: nothing
    int32_t since = 0;       ///< the observation at which it began to wait, or kNotWaiting
    bool operator==(const Waiting&) const = default;
  };
  static constexpr size_t kAll = ~size_t{0};

  /// Work that is spread over calls: a topic, and a brick that was seen, is told in one call of `of`, the one
  /// that has its number. Which one is the same always.
  struct Turn {
    int32_t number = 0;  ///< in [0, of)
    int32_t of = 1;      ///< > 0
  };

  /// Whole pieces whose content differs from what was told, ascending by key. A topic that is gone comes as
  /// a retired piece (weight 0, no words). Beliefs must be of one robot with versions that grow.
  ///
  /// A model that learns changes its mind everywhere, and to tell all of a large map takes long: of bricks of
  /// labels and of certainties at most `most_bricks` come, first those that were seen since the last call,
  /// then those that have waited longest. The others wait; with kAll none does.
  ///
  /// Cost: O(cells) to find out, a few nanoseconds each; what is told, all that it holds.
  std::vector<Piece> update(const LocalBelief& belief, size_t most_bricks = kAll);

  /// The same of a belief of any size at a bounded cost. Looked at are the bricks that were seen, those that
  /// wait to be told, and of the others so many, one after the other, as have `most_cells` cells in all: that
  /// one of those has changed is found out when it is looked at. What is told of a brick is what is believed
  /// now. A map of up to `most_cells` cells is looked at as a whole, and told as by the function above.
  ///
  /// @param outline  the belief; its cells are not looked at.
  /// @param seen     the bricks of which cells were seen since the last call.
  /// @param turn     topics of other turns are not told, and bricks of other turns count as not seen yet.
  /// Cost: O(cells of the bricks looked at + log of the bricks there are).
  std::vector<Piece> update(const LocalBelief& outline, const BelievedBricks& bricks,
                            const std::set<Brick>& seen, size_t most_bricks, size_t most_cells,
                            const Turn& turn);
  std::vector<Piece> update(const LocalBelief& outline, const BelievedBricks& bricks,
                            const std::set<Brick>& seen, size_t most_bricks, size_t most_cells) {
    return update(outline, bricks, seen, most_bricks, most_cells, Turn{});
  }

  /// What differs from what was told, and what was found to differ, ascending by key; when all of the belief
  /// was looked at: what was found.
  std::vector<Waiting> waiting() const;
  /// Topics that were not told yet as they are among them.
  /// @param outline, bricks  the belief of the last call. Cost: O(cells).
  std::vector<Waiting> waiting(const LocalBelief& outline, const BelievedBricks& bricks) const;

  /// The brick at which the look at those not seen has arrived.
  const std::optional<Brick>& lookedUntil() const { return looked_until_; }

  /// The bricks that were seen and whose turn has not come since.
  const std::set<Brick>& seen() const { return seen_; }

  /// As if all of `belief` had just been told but these.
  void restore(const LocalBelief& belief, const std::vector<Waiting>& waiting,
               const std::optional<Brick>& looked_until = {}, const std::set<Brick>& seen = {});

  static constexpr int32_t kNotWaiting = -1;  ///< since: nobody has found out yet

 private:
  struct Told {
    uint64_t hash = 0;  // of the content alone, version left out
    int32_t since = kNotWaiting;
  };
  class Round;
  std::vector<Piece> changedTopics(const LocalBelief& belief, const Turn& turn);

  std::map<PieceKey, Told> told_;
  std::set<std::pair<int32_t, PieceKey>> waiting_;  // of bricks, by since
  std::optional<Brick> looked_until_;
  std::set<Brick> seen_;         // their turn has not come
  world::Timestamp seen_until_;  // by the belief before
};

}  // namespace shoal::mapping
