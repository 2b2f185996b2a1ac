// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/background_save.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>

#include "shoal/mapping/atomic_file.h"

namespace shoal::robot_agent {
namespace {

class BackgroundSaveTest : public testing::Test {
 protected:
  BackgroundSaveTest() { EXPECT_EQ(::pipe(gate_.data()), 0); }
  ~BackgroundSaveTest() override {
    ::unlink(path_.c_str());
    for (const int end : gate_) ::close(end);
  }

  // In the child: says that it runs, and waits to be let go on.
  void waitAtGate() {
    mapping::writeFileAtomically(path_, std::to_string(::getpid()));
    char go = 0;
    while (::read(gate_[0], &go, 1) != 1) {
    }
  }
  void openGate() { EXPECT_EQ(::write(gate_[1], "x", 1), 1); }
  pid_t child() {
    while (true) {
      if (std::ifstream file(path_); file.good()) return std::stoi(mapping::readFile(path_));
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  const std::string path_ = testing::TempDir() + "/background_save." + std::to_string(::getpid());
  std::array<int, 2> gate_{};
  BackgroundSave saving_;
};

TEST_F(BackgroundSaveTest, SavesWhatWasThereWhenItBegan) {
  std::string held = "then";
  saving_.begin([&] {
    waitAtGate();
    mapping::writeFileAtomically(path_, held);
    held = "in the child";
  });
  child();
  held = "now";
  EXPECT_TRUE(saving_.isRunning());
  EXPECT_TRUE(saving_.look());
  openGate();
  saving_.wait();
  EXPECT_FALSE(saving_.isRunning());
  EXPECT_FALSE(saving_.look());
  EXPECT_EQ(held, "now");
  EXPECT_EQ(mapping::readFile(path_), "then");
}

TEST_F(BackgroundSaveTest, LookingFindsOutThatItIsDone) {
  saving_.begin([] {});
  while (saving_.look()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_FALSE(saving_.isRunning());
  saving_.begin([] {});  // and another
  EXPECT_TRUE(saving_.isRunning());
}

TEST_F(BackgroundSaveTest, SignalsToStopDoNotEndIt) {
  saving_.begin([&] {
    waitAtGate();
    mapping::writeFileAtomically(path_, "whole");
  });
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) ::kill(child(), signal);
  openGate();
  saving_.wait();
  EXPECT_EQ(mapping::readFile(path_), "whole");
}

TEST_F(BackgroundSaveTest, TellsWhatWentWrongThere) {
  saving_.begin([] { throw std::runtime_error("cannot write R00.checkpoint: no space"); });
  try {
    saving_.wait();
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "cannot write R00.checkpoint: no space");
  }
  EXPECT_FALSE(saving_.isRunning());
}

TEST_F(BackgroundSaveTest, TellsThatItWasKilled) {
  saving_.begin([&] { waitAtGate(); });
  ::kill(child(), SIGKILL);
  EXPECT_THROW(saving_.wait(), std::runtime_error);
}

TEST_F(BackgroundSaveTest, OneAtATime) {
  saving_.begin([&] { waitAtGate(); });
  EXPECT_DEATH(saving_.begin([] {}), "isRunning");
  openGate();
}

TEST_F(BackgroundSaveTest, WhoLeavesWaitsForIt) {
  {
    BackgroundSave saving;
    saving.begin([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
      mapping::writeFileAtomically(path_, "whole");
    });
  }
  EXPECT_EQ(mapping::readFile(path_), "whole");
}

}  // namespace
}  // namespace shoal::robot_agent
