// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/progress.h"

#include <map>
#include <string>

#include <gtest/gtest.h>

namespace shoal::console {
namespace {

TEST(ProgressLinesTest, ShowEveryRobotAndOneBarWithTheTimeItWillTake) {
  std::map<std::string, wire::Heartbeat> nodes;
  nodes["R00"].observation = 9;
  nodes["R00"].num_observations = 20;
  nodes["R00"].num_topics = 7;
  nodes["R00"].bytes_sent = 1234;
  const auto lines = progressLines(
      {.num_robots = 2, .observations = 20, .elapsed_s = 30, .doing = "flying", .nodes = &nodes}, 60, 24);
  ASSERT_EQ(lines.size(), 3u);
  EXPECT_EQ(lines[0], "R00     10/20 frames   7 topics    1234 B");
  EXPECT_EQ(lines[1], "R01  not heard yet");
  EXPECT_EQ(lines[2].substr(0, 58), "[##########..............................]  25 %  10/40 fr");
}

TEST(TerminalBlockTest, WithoutATerminalTheBarIsSaidOnceAMinute) {
  const std::map<std::string, wire::Heartbeat> nodes;
  TerminalBlock block;
  if (block.isTerminal()) GTEST_SKIP() << "stderr is a terminal";
  std::string said;
  for (double elapsed_s = 0; elapsed_s < 130; elapsed_s += 0.25) {
    testing::internal::CaptureStderr();
    block.draw(
        {.num_robots = 3, .observations = 8, .elapsed_s = elapsed_s, .doing = "flying", .nodes = &nodes});
    said += testing::internal::GetCapturedStderr();
  }
  const std::string bar = "[........................................]   0 %  0/24 frames  ";
  EXPECT_EQ(said, bar + "1:00  flying\n" + bar + "2:00  flying\n");
}

TEST(TerminalBlockTest, IsErasedFromTheBeginningOfALine) {
  EXPECT_EQ(erasing(3), "\r\033[3A\033[J");  // ^C may have moved the cursor
  EXPECT_EQ(erasing(0), "");
}

TEST(ProgressLinesTest, TellTheTimeThatIsLeftFromTheShareThatIsDone) {
  std::map<std::string, wire::Heartbeat> nodes;
  nodes["R00"].observation = 4;
  nodes["R00"].num_observations = 20;
  const auto lines = progressLines(
      {.num_robots = 1, .observations = 20, .elapsed_s = 30, .doing = "flying", .nodes = &nodes}, 200, 24);
  EXPECT_NE(lines.back().find("5/20 frames  0:30  ETA 1:30  flying"), std::string::npos) << lines.back();
}

TEST(ProgressLinesTest, FitTheTerminal) {
  const std::map<std::string, wire::Heartbeat> nodes;
  for (const size_t width : {20u, 50u, 100u, 300u}) {
    for (const size_t height : {2u, 8u, 60u}) {
      const auto lines = progressLines(
          {.num_robots = 50, .observations = 0, .elapsed_s = 1, .doing = "flying", .nodes = &nodes}, width,
          height);
      EXPECT_LE(lines.size(), height);
      for (const std::string& line : lines) EXPECT_LE(line.size(), width);
    }
  }
}

}  // namespace
}  // namespace shoal::console
