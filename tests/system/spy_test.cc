// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/spy.h"

#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shoal/wire/heartbeat_codec.h"

namespace shoal::console {
namespace {

comms::Packet heartbeat(const std::string& node, double at_s, int budget) {
  wire::Heartbeat h;
  h.time = {static_cast<int64_t>(at_s * 1e6)};
  h.budget = budget;
  return {"SHOAL_" + node + "_HEARTBEAT", wire::encode(h)};
}

TEST(SpyTest, CountsBytesOnTheWireAgainstTheBudget) {
  Spy spy({});
  const comms::Packet packet = heartbeat("R03", 0, 1000);
  const auto size = static_cast<double>(comms::wireSize(packet));
  for (int i = 0; i < 20; ++i) spy.hear(heartbeat("R03", i, 1000), i);  // one a second
  spy.hear({"CAMERA_IMAGE", comms::Bytes(5000)}, 19.5);
  const auto a = spy.json(20);
  EXPECT_EQ(a["messages"], 21);
  EXPECT_EQ(a["channels"][0]["type"], "?");
  EXPECT_EQ(a["channels"][0]["refused"], 0);  // none of ours
  EXPECT_EQ(a["channels"][1]["channel"], "SHOAL_R03_HEARTBEAT");
  EXPECT_NEAR(a["channels"][1]["hz"].get<double>(), 0.9, 0.11);  // of the last ten seconds
  EXPECT_EQ(a["nodes"][0]["bytes"], 20 * size);
  EXPECT_NEAR(a["nodes"][0]["bytes_per_s"].get<double>(), 20 * size / 19, 0.1);
  EXPECT_NEAR(a["nodes"][0]["worst"].get<double>(), 2 * size / 1000, 0.01);  // both ends of a second
  EXPECT_FALSE(a["channels"][1].contains("last"));
}

TEST(SpyTest, DecodesWhatIsAskedForAndStillMetersTheRest) {
  Spy spy(std::regex("SHOAL_R03_.*"));
  spy.hear(heartbeat("R03", 1, 10), 1);
  spy.hear(heartbeat("R04", 1, 10), 1);
  const auto a = spy.json(2);
  ASSERT_EQ(a["channels"].size(), 1u);
  EXPECT_EQ(a["channels"][0]["last"]["utime"], 1'000'000);
  EXPECT_EQ(a["nodes"].size(), 2u);
  EXPECT_NE(spy.text(2).find("\n  phase              flying\n"), std::string::npos);
}

TEST(SpyTest, RubbishIsCountedNotTrusted) {
  Spy spy(std::regex(".*"));
  comms::Packet torn = heartbeat("R03", 1, 10);
  torn.bytes.pop_back();
  spy.hear(torn, 0);
  spy.hear({"SHOAL_R03_HEARTBEAT", {1, 2, 3}}, 0);
  spy.hear({"SHOAL_R03_BRICK", heartbeat("R03", 1, 10).bytes}, 0);
  const auto a = spy.json(1);
  EXPECT_EQ(a["channels"][0]["refused"], 1);
  EXPECT_EQ(a["channels"][1]["refused"], 2);
  EXPECT_TRUE(a["channels"][1]["last"].contains("refused"));
}

TEST(SpyTest, AFloodOfChannelsStaysBoundedAndLinesFit) {
  Spy spy({});
  for (int i = 0; i < 3000; ++i) {
    spy.hear({std::string(50, 'X') + std::to_string(i), {1}}, 0);
    spy.hear(heartbeat("N" + std::to_string(i), 1, 10), 0);
  }
  const auto a = spy.json(1);
  EXPECT_EQ(a["channels"].size(), 1000u);
  EXPECT_EQ(a["nodes"].size(), 1000u);
  EXPECT_EQ(a["unlisted"], 5000);
  EXPECT_NE(spy.text(1, false).find("\n" + std::string(50, 'X') + "0 "), std::string::npos);  // for a file
  std::istringstream lines(spy.text(1));
  for (std::string line; std::getline(lines, line);) EXPECT_LE(line.size(), 80u) << line;
}

}  // namespace
}  // namespace shoal::console
