// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/mission_clock.h"

#include <cmath>
#include <stdexcept>

#include <gtest/gtest.h>

#include "fake_wall.h"

namespace shoal::comms {
namespace {

TEST(MissionClockTest, RunsAtItsRate) {
  for (const double rate : {1.0, 10.0, 0.5}) {
    SCOPED_TRACE(rate);
    FakeWall wall;
    MissionClock clock(rate, 5'000'000, wall.time());
    EXPECT_EQ(clock.now(), 5'000'000);
    wall.pass(200'000);
    EXPECT_EQ(clock.now(), 5'000'000 + static_cast<int64_t>(200'000 * rate));
    const int64_t before_us = wall.now();
    clock.waitUntil(15'000'000);
    EXPECT_GE(clock.now(), 15'000'000);
    EXPECT_NEAR(static_cast<double>(wall.now() - before_us), 10'000'000 / rate - 200'000, 2);
  }
}

TEST(MissionClockTest, WaitsAgainWhenASleepEndsEarly) {
  FakeWall wall;
  WallTime lazy = wall.time();
  lazy.sleep_us = [&wall](int64_t us) { wall.pass((us + 1) / 2); };
  MissionClock clock(1, 0, lazy);
  clock.waitUntil(1'000'000);
  EXPECT_EQ(wall.now(), 123'456 + 1'000'000);
}

TEST(MissionClockTest, AsFastAsPossibleNeverWaits) {
  FakeWall wall;
  MissionClock clock(0, 0, wall.time());
  wall.pass(5'000'000);
  EXPECT_EQ(clock.now(), 0);
  EXPECT_EQ(clock.wallUntil(1'000'000), 0);
  clock.waitUntil(1'000'000);
  EXPECT_EQ(clock.now(), 1'000'000);
  clock.advanceTo(3'000'000);
  clock.waitUntil(2'000'000);
  EXPECT_EQ(clock.now(), 3'000'000);
  EXPECT_TRUE(wall.sleeps().empty());
}

TEST(MissionClockTest, GoesOnFromWhereItWasAdvancedTo) {
  FakeWall wall;
  MissionClock clock(10, 0, wall.time());
  wall.pass(100'000);
  clock.advanceTo(3'600'000'000);
  EXPECT_EQ(clock.now(), 3'600'000'000);
  wall.pass(200'000);
  EXPECT_EQ(clock.now(), 3'602'000'000);
  EXPECT_EQ(clock.wallUntil(3'604'000'000), 200'000);
}

TEST(MissionClockTest, NeverRunsBackwards) {
  FakeWall wall;
  MissionClock clock(1, 0, wall.time());
  wall.pass(10'000'000);
  clock.advanceTo(9'000'000);
  EXPECT_EQ(clock.now(), 10'000'000);
  wall.pass(-1'000'000);
  EXPECT_EQ(clock.now(), 10'000'000);
}

TEST(MissionClockTest, RejectsARateOutOfRange) {
  for (const double rate : {-1.0, 0.0001, 1001.0, std::nan("")}) {
    EXPECT_THROW(MissionClock(rate, 0), std::invalid_argument) << rate;
  }
}

}  // namespace
}  // namespace shoal::comms
