// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/ids.h"

#include <cstdio>
#include <string>

#include <gtest/gtest.h>

namespace shoal::world {
namespace {

TEST(RobotNameTest, HasAtLeastTwoDigits) {
  EXPECT_EQ(name(RobotId{0}), "R00");
  EXPECT_EQ(name(RobotId{3}), "R03");
  EXPECT_EQ(name(RobotId{47}), "R47");
  EXPECT_EQ(name(RobotId{100}), "R100");
}

TEST(RobotNameTest, ComesBackForEveryRobot) {
  for (int i = 0; i <= 9999; ++i) {
    ASSERT_EQ(parseRobotId(name(RobotId{i})), RobotId{i}) << i;
  }
}

TEST(RobotNameTest, IsTheOnlyTextThatIsParsed) {
  for (const char* bad : {"", "R", "R0", "R1", "r03", "03", "R 3", "R003", "R0100", "R00000", "R10000", "R-1",
                          "R3x", "R+1", " R03", "R03 ", "R1e2"}) {
    EXPECT_EQ(parseRobotId(bad), std::nullopt) << bad;
  }
  // Every text of R and one to five digits.
  for (int digits = 1; digits <= 5; ++digits) {
    int values = 1;
    for (int i = 0; i < digits; ++i) values *= 10;
    for (int i = 0; i < values; i += digits < 5 ? 1 : 37) {
      char text[16];
      std::snprintf(text, sizeof text, "R%0*d", digits, i);
      char canonical[16];
      std::snprintf(canonical, sizeof canonical, "R%02d", i);
      const bool good = i <= 9999 && std::string(text) == canonical;
      ASSERT_EQ(parseRobotId(text).has_value(), good) << text;
    }
  }
}

TEST(GlobalLabelTest, IsRobotTimesTenThousandPlusTopic) {
  EXPECT_EQ(number(globalLabel(RobotId{12}, TopicId{34})), 120034);
  EXPECT_EQ(number(globalLabel(RobotId{0}, TopicId{kMaxTopicId})), 9999);
}

TEST(CellIndexTest, IsOrderedByXThenYThenZ) {
  EXPECT_LT((CellIndex{-1, 9, 9}), (CellIndex{0, -9, -9}));
  EXPECT_LT((CellIndex{1, 2, 9}), (CellIndex{1, 3, -9}));
  EXPECT_LT((CellIndex{1, 2, -1}), (CellIndex{1, 2, 0}));
}

TEST(VersionTest, CountsEpochsBeforeObservations) { EXPECT_LT((Version{0, 99}), (Version{1, 0})); }

}  // namespace
}  // namespace shoal::world
