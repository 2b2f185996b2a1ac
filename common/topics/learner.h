// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "shoal/topics/snapshot.h"
#include "shoal/topics/team_topics.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// What a robot learns its topics with: images come in as words in cells, topics and labels come out. The
/// state is a function of how the learner was made and of the images so far. Topic ids ascend with creation
/// and are never used again.
class Learner {
 public:
  virtual ~Learner() = default;

  /// Takes in one image and does the work that every image is worth: a count, never a clock.
  /// @throws std::invalid_argument, leaving the learner as it was, if `words` breaks its contract or its
  ///         observation number is not above the last one's.
  virtual void observe(const world::WordsInCells& words) = 0;

  /// Whether lookAgain() is for this kind of learner.
  virtual bool canLookAgain() const { return false; }

  /// Judges every cell anew by what the whole team knows: a topic speaks with the words of all topics of its
  /// label, and the others vote (team_opinion.h). Changes what is told of cells, and nothing of what is
  /// learnt.
  /// @param breathe  Called every few thousand cells, so that who has other things to do can do them. It must
  ///                 not touch the learner, nor read what is told of its cells.
  /// @throws std::invalid_argument for words that the learner does not have; std::logic_error from a learner
  ///         that cannot.
  virtual void lookAgain(
      const TeamTopics& team, const std::function<void()>& breathe = [] {});

  /// Topics as exact counts, every cell with its label. It reads everything.
  virtual Snapshot snapshot() const = 0;

  /// snapshot() without its cells: costs the same on every map.
  virtual Snapshot outline() const = 0;

  /// What snapshot() says of these cells, in their order; those not known are left out.
  virtual std::vector<CellLabel> labels(std::span<const world::CellIndex> cells) const = 0;

  /// The whole state as bytes: what is resumed from them (resumeLearner()) goes on as this learner does, byte
  /// for byte.
  virtual std::vector<uint8_t> checkpoint() const = 0;

  virtual int32_t numCells() const = 0;
  virtual int32_t numTopics() const = 0;

 protected:
  Learner() = default;
  Learner(const Learner&) = default;
  Learner& operator=(const Learner&) = default;
};

}  // namespace shoal::topics
