// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/sent_bytes.h"

#include <cstdint>

#include <gtest/gtest.h>

namespace shoal::fusion_node {
namespace {

wire::Heartbeat beat(int64_t second, int64_t bytes, int32_t pid, int32_t epoch = 0) {
  wire::Heartbeat h;
  h.time = {second * 1'000'000};
  h.pid = pid;
  h.epoch = epoch;
  h.bytes_sent = bytes;
  h.class_bytes = {bytes / 10, 0, bytes / 2};
  return h;
}

TEST(SentBytesTest, TheLastWordsOfAllLivesAreAddedUp) {
  SentBytes sent;
  EXPECT_EQ(sent.sum().bytes, 0);
  for (const auto& h : {beat(1, 100, 7), beat(2, 400, 7), beat(5, 40, 8), beat(6, 60, 8)}) sent.heard(h);
  EXPECT_EQ(sent.sum().bytes, 460);
  EXPECT_EQ(sent.sum().of_class[0], 46);
  EXPECT_EQ(sent.sum().of_class[2], 230);
  for (const auto& h : {beat(1, 100, 7), beat(5, 40, 8), beat(6, 60, 8)}) sent.heard(h);  // late, or twice
  EXPECT_EQ(sent.sum().bytes, 460);
}

// As in a container, where every life is process 1.
TEST(SentBytesTest, WhoCountsFromNothingIsAnotherWhateverItsNumber) {
  SentBytes sent;
  for (const auto& h : {beat(1, 100, 1), beat(9, 400, 1), beat(10, 30, 1), beat(11, 50, 1)}) sent.heard(h);
  EXPECT_EQ(sent.sum().bytes, 450);
  sent.heard(beat(3, 20, 1, 1));  // one that was voided: a greater epoch, from the start
  EXPECT_EQ(sent.sum().bytes, 470);
  sent.heard(beat(12, 50, 1));  // late
  EXPECT_EQ(sent.sum().bytes, 470);
}

TEST(SentBytesTest, ManyLivesAreAddedUpToo) {
  SentBytes sent;
  for (int32_t life = 0; life < 100; ++life) {
    sent.heard(beat(2 * life, 10, life));
    sent.heard(beat(2 * life + 1, 20, life));
  }
  EXPECT_EQ(sent.sum().bytes, 2000);
}

TEST(SentBytesTest, CraftedCountsDoNotOverflow) {
  SentBytes sent;
  for (int32_t life = 0; life < 100; ++life) sent.heard(beat(life, INT64_MAX, life));
  EXPECT_EQ(sent.sum().bytes, INT64_MAX);
}

}  // namespace
}  // namespace shoal::fusion_node
