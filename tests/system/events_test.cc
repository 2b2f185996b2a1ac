// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/event_log.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "fusion_node/silence_alarm.h"

namespace shoal::fusion_node {
namespace {

wire::Heartbeat at(double s, wire::Phase phase = wire::Phase::kFlying, int epoch = 0, int pid = 1) {
  wire::Heartbeat h;
  h.time = {static_cast<int64_t>(s * 1e6)};
  h.phase = phase;
  h.epoch = epoch;
  h.pid = pid;
  h.budget = 2000;
  return h;
}

std::vector<std::string> kinds(const EventLog& log) {
  std::vector<std::string> kinds;
  for (const auto& e : log.events()) kinds.push_back(e.kind);
  return kinds;
}

TEST(EventLogTest, TellsWhatHappensToANode) {
  EventLog log;
  log.heard("R01", at(1));
  log.heard("R01", at(2));
  log.passTime(9);
  EXPECT_EQ(kinds(log), std::vector<std::string>{"joined"});
  log.passTime(10);
  log.passTime(30);  // told once
  log.heard("R01", at(31));
  log.heard("R01", at(32, wire::Phase::kLanded));
  log.heard("R01", at(31.5));  // late: it has landed all the same
  log.heard("R01", at(33, wire::Phase::kFlying, 1, 2));
  log.heard("R01", at(34, wire::Phase::kLeaving, 1, 2));
  log.passTime(99);  // it left
  EXPECT_EQ(kinds(log), (std::vector<std::string>{"joined", "lost", "back", "landed", "again", "leaving"}));
}

TEST(EventLogTest, ARobotLandsOnceAndLooksAgain) {
  EventLog log;
  log.heard("R01", at(1));
  log.heard("R01", at(2, wire::Phase::kListening));
  log.heard("R01", at(3, wire::Phase::kListening));
  log.heard("R01", at(4, wire::Phase::kLanded));
  EXPECT_EQ(kinds(log), (std::vector<std::string>{"joined", "landed", "looked"}));
}

TEST(EventLogTest, OnAThinBudgetPatienceIsLonger) {
  EventLog log;
  wire::Heartbeat thin = at(1);
  thin.budget = 50;  // a heartbeat takes up to 50 s
  log.heard("R01", thin);
  log.passTime(199);
  EXPECT_EQ(kinds(log).size(), 1u);
  log.passTime(201);
  EXPECT_EQ(kinds(log).back(), "lost");
}

TEST(EventLogTest, TwoProcessesWithOneNameAreTold) {
  EventLog log;
  log.heard("R01", at(1));
  for (int i = 0; i < 9; ++i) log.heard("R01", at(2 + i, wire::Phase::kFlying, 0, 1 + i % 2));
  EXPECT_EQ(kinds(log), (std::vector<std::string>{"joined", "twin"}));
}

TEST(EventLogTest, WhoTakesUpWhereAnotherEndedIsNoTwin) {
  EventLog log;
  for (int i = 0; i < 9; ++i) log.heard("R01", at(1 + i, wire::Phase::kFlying, 0, 1 + i / 3));
  EXPECT_EQ(kinds(log), (std::vector<std::string>{"joined"}));
}

TEST(EventLogTest, RefusalsAreToldAtPowersOfTenAndStayBounded) {
  EventLog log;
  comms::Stats stats;
  for (int i = 0; i < 100; ++i) {
    stats.countRejected("checksum");
    log.refused("SHOAL_R01_BRICK", stats);
  }
  EXPECT_EQ(log.events().size(), 3u);
  EXPECT_EQ(log.events().back().says, "100 messages: checksum");
  for (int i = 0; i < 20000; ++i) {
    stats.countRejected("channel");
    log.refused("X" + std::to_string(i), stats);
    log.heard("N" + std::to_string(i), at(i));
  }
  EXPECT_LE(log.events().size(), 5000u);
}

TEST(SilenceAlarmTest, WarnsOnceUntilSomethingIsHeard) {
  SilenceAlarm alarm(2000, 0);
  EXPECT_FALSE(alarm.check(4999));
  EXPECT_NE(alarm.check(5000)->find("operator_console doctor"), std::string::npos);
  EXPECT_FALSE(alarm.check(60000));
  alarm.heard(60000);
  EXPECT_FALSE(alarm.check(64999));
  EXPECT_EQ(*alarm.check(65000), "nobody else was heard for 5 s");
  EXPECT_FALSE(SilenceAlarm(50, 0).check(99'999));
}

}  // namespace
}  // namespace shoal::fusion_node
