// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/topic_slots.h"

#include "shoal/demand.h"

namespace shoal::topics {

TopicSlots::TopicSlots(int32_t max_topics) : slots_(static_cast<size_t>(max_topics)) {}

void TopicSlots::open(int32_t slot) {
  SHOAL_DEMAND(!isOpen(slot) && canOpen());
  at(slot) = {.open = true, .id = -1, .openings = at(slot).openings + 1, .created = {}};
  ++num_open_;
  ++num_unnamed_;
  findEnds();
}

void TopicSlots::close(int32_t slot) {
  SHOAL_DEMAND(isOpen(slot));
  if (at(slot).id < 0) --num_unnamed_;
  at(slot) = {.open = false, .id = -1, .openings = at(slot).openings, .created = {}};
  --num_open_;
  findEnds();
}

void TopicSlots::nameTopics(world::Timestamp now) {
  if (num_unnamed_ == 0) return;
  for (Slot& slot : slots_) {
    if (!slot.open || slot.id >= 0) continue;
    slot.id = next_id_++;
    slot.created = now;
  }
  num_unnamed_ = 0;
}

void TopicSlots::restore(int32_t num_ids_used, std::span<const Named> open) {
  SHOAL_DEMAND(num_open_ == 0 && next_id_ == 0);
  for (const Named& topic : open) {
    at(topic.slot) = {.open = true, .id = number(topic.id), .openings = 1, .created = topic.created};
  }
  num_open_ = static_cast<int32_t>(open.size());
  next_id_ = num_ids_used;
  findEnds();
}

world::TopicId TopicSlots::id(int32_t slot) const {
  SHOAL_DEMAND(at(slot).id >= 0);
  return world::TopicId{at(slot).id};
}

void TopicSlots::findEnds() {
  for (first_closed_ = 0; first_closed_ < size() && isOpen(first_closed_);) ++first_closed_;
  for (end_ = size(); end_ > 0 && !isOpen(end_ - 1);) --end_;
}

}  // namespace shoal::topics
