// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/later_life.h"

#include <gtest/gtest.h>

namespace shoal::robot_agent {
namespace {

world::Observation observed(int32_t number, int64_t time_us) {
  world::Observation observation;
  observation.number = number;
  observation.time = {time_us};
  return observation;
}

TEST(LaterLifeTest, WhatWasLearntFromIsLeftOut) {
  LaterLife life(false, 9'000'000);
  world::Observation known = observed(4, 400), next = observed(5, 500);
  EXPECT_FALSE(life.follows(4, known));
  EXPECT_TRUE(life.follows(4, next));
  EXPECT_EQ(next.number, 5);
  EXPECT_EQ(next.time.us, 500);
}

TEST(LaterLifeTest, NumbersAndTimesOfALiveSourceGoOn) {
  LaterLife life(true, 9'000'000);
  int32_t last = 10;
  for (int32_t number : {0, 1, 2}) {
    world::Observation shown = observed(number, 100 * number);
    ASSERT_TRUE(life.follows(last, shown));
    EXPECT_EQ(shown.number, 11 + number);
    EXPECT_EQ(shown.time.us, 9'000'000 + 100 * number);
    last = shown.number;
  }
}

TEST(LaterLifeTest, TimesOfTheMissionStayAsTheyAre) {
  LaterLife life(true, 0);
  world::Observation shown = observed(0, 9'000'100);
  ASSERT_TRUE(life.follows(10, shown));
  EXPECT_EQ(shown.number, 11);
  EXPECT_EQ(shown.time.us, 9'000'100);
}

TEST(LaterLifeTest, InTheFirstLifeNothingChanges) {
  for (const bool live : {false, true}) {
    LaterLife life(live, 0);
    world::Observation first = observed(0, 7), second = observed(1, 8);
    EXPECT_TRUE(life.follows(-1, first) && life.follows(0, second));
    EXPECT_EQ(first.number, 0);
    EXPECT_EQ(second.number, 1);
    EXPECT_EQ(second.time.us, 8);
  }
}

}  // namespace
}  // namespace shoal::robot_agent
