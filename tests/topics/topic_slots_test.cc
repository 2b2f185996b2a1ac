// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/topic_slots.h"

#include <gtest/gtest.h>

namespace shoal::topics {
namespace {

using world::Timestamp;

TEST(TopicSlotsTest, IdsAscendWithCreationAndRememberIt) {
  TopicSlots slots(4);
  slots.open(2);
  slots.nameTopics(Timestamp{100});
  slots.open(0);
  slots.nameTopics(Timestamp{200});
  EXPECT_EQ(number(slots.id(2)), 0);
  EXPECT_EQ(number(slots.id(0)), 1);
  EXPECT_EQ(slots.created(2), Timestamp{100});
  EXPECT_EQ(slots.created(0), Timestamp{200});
}

TEST(TopicSlotsTest, AReopenedSlotIsANewTopic) {
  TopicSlots slots(2);
  slots.open(0);
  slots.nameTopics(Timestamp{1});
  slots.close(0);
  slots.open(0);
  slots.nameTopics(Timestamp{2});
  EXPECT_EQ(number(slots.id(0)), 1);
  EXPECT_EQ(slots.created(0), Timestamp{2});
}

TEST(TopicSlotsTest, ATopicThatDiesUnnamedCostsNoId) {
  TopicSlots slots(2);
  slots.open(0);
  slots.close(0);
  slots.open(1);
  slots.nameTopics(Timestamp{});
  EXPECT_EQ(number(slots.id(1)), 0);
  EXPECT_EQ(slots.numIdsUsed(), 1);
}

TEST(TopicSlotsTest, KnowTheFirstClosedSlotAndTheEnd) {
  TopicSlots slots(3);
  EXPECT_EQ(slots.firstClosed(), 0);
  EXPECT_EQ(slots.end(), 0);
  slots.open(0);
  slots.open(2);
  EXPECT_EQ(slots.firstClosed(), 1);
  EXPECT_EQ(slots.end(), 3);
  slots.close(2);
  EXPECT_EQ(slots.end(), 1);
  slots.open(1);
  slots.open(2);
  EXPECT_EQ(slots.firstClosed(), slots.size());
}

// Ids 0 to 9999 are handed out, each once; then nothing opens any more.
TEST(TopicSlotsTest, NothingOpensOnceTheIdsHaveRunOut) {
  TopicSlots slots(2);
  for (int32_t id = 0; id <= world::kMaxTopicId; ++id) {
    ASSERT_TRUE(slots.canOpen()) << id;
    slots.open(0);
    slots.nameTopics(Timestamp{});
    ASSERT_EQ(number(slots.id(0)), id);
    slots.close(0);
  }
  EXPECT_FALSE(slots.canOpen());
}

TEST(TopicSlotsTest, AnUnnamedTopicHoldsAnId) {
  TopicSlots slots(2);
  for (int32_t id = 0; id < world::kMaxTopicId; ++id) {
    slots.open(0);
    slots.nameTopics(Timestamp{});
    slots.close(0);
  }
  slots.open(0);  // will be 9999
  EXPECT_FALSE(slots.canOpen());
  slots.close(0);  // or not
  EXPECT_TRUE(slots.canOpen());
}

}  // namespace
}  // namespace shoal::topics
