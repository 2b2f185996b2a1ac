// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/world/ids.h"

namespace shoal::topics {

/// Which columns of the count tables hold a topic, and what that topic is called.
///
/// A slot is a place and may be used again; an id is a name and may not: a slot that empties gives up its
/// id for good, and whatever opens there next is another topic with the next fresh id. Ids are handed out
/// by nameTopics() at the end of a call of the model, so that a topic that flickered up and died between
/// two snapshots costs none; creation is the observation during which the topic opened.
class TopicSlots {
 public:
  explicit TopicSlots(int32_t max_topics);

  int32_t size() const { return static_cast<int32_t>(slots_.size()); }
  int32_t numOpen() const { return num_open_; }
  int32_t numIdsUsed() const { return next_id_; }
  bool isOpen(int32_t slot) const { return at(slot).open; }

  /// The first slot without a topic, size() if there is none.
  int32_t firstClosed() const { return first_closed_; }

  /// One above the last open slot; 0 if none is open.
  int32_t end() const { return end_; }

  /// Is an id left for one more topic? Once false, it stays so but for topics that die unnamed.
  bool canOpen() const { return numIdsLeft() > 0; }
  int32_t numIdsLeft() const { return world::kMaxTopicId + 1 - next_id_ - num_unnamed_; }

  /// How often it was opened: which topic of all that were there.
  uint32_t openings(int32_t slot) const { return at(slot).openings; }

  void open(int32_t slot);
  void close(int32_t slot);

  /// Gives every open topic without an id the next one, ascending by slot, created `now`.
  void nameTopics(world::Timestamp now);

  /// A topic with its name, and where it is kept.
  struct Named {
    int32_t slot = 0;
    world::TopicId id{};
    world::Timestamp created;
  };

  /// Makes fresh slots what others were after nameTopics(): ids below `num_ids_used` are never used again.
  /// @param open  Ascending by slot, ids below num_ids_used.
  void restore(int32_t num_ids_used, std::span<const Named> open);

  /// Of an open slot, after nameTopics().
  world::TopicId id(int32_t slot) const;
  world::Timestamp created(int32_t slot) const { return at(slot).created; }

 private:
  struct Slot {
    bool open = false;
    int32_t id = -1;  // -1: no name yet
    uint32_t openings = 0;
    world::Timestamp created;
  };

  const Slot& at(int32_t slot) const { return slots_[static_cast<size_t>(slot)]; }
  Slot& at(int32_t slot) { return slots_[static_cast<size_t>(slot)]; }
  void findEnds();

  std::vector<Slot> slots_;
  int32_t num_open_ = 0;
  int32_t num_unnamed_ = 0;
  int32_t next_id_ = 0;
  int32_t first_closed_ = 0;
  int32_t end_ = 0;
};

}  // namespace shoal::topics
