// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/moment.h"

#include <gtest/gtest.h>

namespace shoal::fusion_node {
namespace {

constexpr int64_t kHourUs = 3'600'000'000, kDayUs = 24 * kHourUs;

TEST(MomentTest, WithinABootNobodySetsTheClock) {
  const Moment then{1000 * kDayUs, 5 * kHourUs, "one"};
  for (const int64_t wall_us : {int64_t{0}, then.wall_us + 1, then.wall_us + 9000 * kDayUs}) {
    const Gap gap = passedBetween(then, {wall_us, 7 * kHourUs, "one"});
    EXPECT_EQ(gap.us, 2 * kHourUs);
    EXPECT_EQ(gap.doubt, "");
  }
}

TEST(MomentTest, AcrossBootsTheWallClockCounts) {
  for (const char* const other : {"two", ""}) {
    const Gap gap = passedBetween({1000 * kDayUs, 5 * kHourUs, "one"}, {1001 * kDayUs, kHourUs, other});
    EXPECT_EQ(gap.us, kDayUs);
    EXPECT_EQ(gap.doubt, "");
  }
  EXPECT_EQ(passedBetween({kDayUs, 1, ""}, {2 * kDayUs, 2, ""}).us, kDayUs);  // of an unknown boot
}

TEST(MomentTest, AWallClockThatCannotBeRightIsNotBelieved) {
  const Moment then{1000 * kDayUs, 5 * kHourUs, "one"};
  const Gap back = passedBetween(then, {then.wall_us - kDayUs, kHourUs, "two"});
  EXPECT_EQ(back.us, 0);
  EXPECT_EQ(back.doubt, "by the wall clock it is 1.000 days in the future");
  EXPECT_EQ(passedBetween(then, {then.wall_us + 30 * kDayUs, kHourUs, "two"}).us, 30 * kDayUs);
  const Gap far = passedBetween(then, {then.wall_us + 31 * kDayUs, kHourUs, "two"});
  EXPECT_EQ(far.us, 0);
  EXPECT_EQ(far.doubt, "by the wall clock it is 31 days old");
}

TEST(MomentTest, ThisMachineKnowsItsBoot) {
  const Moment a = thisMoment(), b = thisMoment();
  EXPECT_FALSE(a.boot_id.empty());
  EXPECT_EQ(a.boot_id, b.boot_id);
  EXPECT_LE(a.boot_us, b.boot_us);
}

}  // namespace
}  // namespace shoal::fusion_node
