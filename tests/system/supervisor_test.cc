// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/supervisor.h"

#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "operator_console/stop_signal.h"

namespace shoal::console {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

// Dead, or dead and not yet buried by whoever inherited it.
bool isGone(pid_t pid) {
  std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  if (!std::getline(stat, text)) return true;
  const size_t state = text.rfind(')') + 2;
  return text.at(state) == 'Z' || text.at(state) == 'X';
}

template <typename Done>
bool within(milliseconds limit, Done&& done) {
  const auto deadline = std::chrono::steady_clock::now() + limit;
  while (!done()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(milliseconds(5));
  }
  return true;
}

class SupervisorTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = testing::TempDir() + "supervisor_XXXXXX";
    folder_ = mkdtemp(pattern.data());
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void startShell(Supervisor& supervisor, const std::string& name, const std::string& script) {
    supervisor.start({name, "/bin/sh", {"-c", script}, folder_ + "/" + name});
  }

  // Starts a parent like launch with three children; returns its pid and waits until theirs are known.
  pid_t startParent(const std::string& mode = "") {
    const pid_t parent = fork();
    if (parent == 0) {
      execl(SUPERVISED, SUPERVISED, folder_.c_str(), "3", mode.empty() ? nullptr : mode.c_str(), nullptr);
      _exit(127);
    }
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(
          within(seconds(10), [&] { return !lastLines(folder_ + "/child" + std::to_string(i), 1).empty(); }));
      children_.push_back(std::stoi(lastLines(folder_ + "/child" + std::to_string(i), 1).at(0)));
    }
    for (const pid_t child : children_) EXPECT_FALSE(isGone(child));
    return parent;
  }

  bool childrenAreGone() const {
    for (const pid_t child : children_) {
      if (!isGone(child)) return false;
    }
    return true;
  }

  std::string folder_;
  std::vector<pid_t> children_;
};

TEST_F(SupervisorTest, ChildrenDieWithAParentThatIsKilled) {
  const pid_t parent = startParent();
  kill(parent, SIGKILL);
  EXPECT_TRUE(within(seconds(2), [this] { return childrenAreGone(); }));
  waitpid(parent, nullptr, 0);
}

TEST_F(SupervisorTest, StubbornChildrenDieWithAParentThatIsKilled) {
  const pid_t parent = startParent("--stubborn");
  kill(parent, SIGKILL);
  EXPECT_TRUE(within(seconds(2), [this] { return childrenAreGone(); }));
  waitpid(parent, nullptr, 0);
}

TEST_F(SupervisorTest, CtrlCEndsTheChildrenFirst) {
  const pid_t parent = startParent();
  kill(parent, SIGINT);
  int status = 0;
  waitpid(parent, &status, 0);
  EXPECT_TRUE(childrenAreGone());
  EXPECT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 130);
}

TEST_F(SupervisorTest, StubbornChildrenAreKilledAfterAWhile) {
  const pid_t parent = startParent("--stubborn");
  kill(parent, SIGTERM);
  int status = 0;
  waitpid(parent, &status, 0);
  EXPECT_TRUE(childrenAreGone());
  EXPECT_EQ(WEXITSTATUS(status), 143);
}

TEST_F(SupervisorTest, AnEarlyDeathIsReportedWithItsLog) {
  Supervisor supervisor;
  startShell(supervisor, "R03", "echo one; echo no such world >&2; exit 3");
  const auto ended = supervisor.wait(seconds(10));
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_EQ(ended[0].name, "R03");
  EXPECT_FALSE(ended[0].inGoodOrder());
  EXPECT_EQ(ended[0].how(), "exited with code 3");
  EXPECT_EQ(lastLines(ended[0].log, 1), std::vector<std::string>{"no such world"});
  EXPECT_EQ(supervisor.numRunning(), 0u);
}

TEST_F(SupervisorTest, SaysWhichSignalKilledAChild) {
  Supervisor supervisor;
  startShell(supervisor, "R00", "kill -SEGV $$");
  const auto ended = supervisor.wait(seconds(10));
  ASSERT_EQ(ended.size(), 1u);
  EXPECT_EQ(ended[0].how(), "was killed by signal 11 (Segmentation fault)");
}

TEST_F(SupervisorTest, SignalsReachTheOneThatIsNamed) {
  Supervisor supervisor;
  startShell(supervisor, "a", "exec sleep 60");
  startShell(supervisor, "b", "exec sleep 60");
  supervisor.signal("a", SIGTERM);
  EXPECT_TRUE(within(seconds(10), [&] { return supervisor.reap().size() == 1; }));
  EXPECT_FALSE(supervisor.isRunning("a"));
  EXPECT_TRUE(supervisor.isRunning("b"));
}

// Handlers, ignored signals, open files and the terminal are the parent's own affair.
TEST_F(SupervisorTest, AChildInheritsNothing) {
  catchStopSignals();
  const std::ifstream open_file("/proc/self/status");
  Supervisor supervisor;
  // No pipe after ls: the shell would have its ends open for a moment. `true` keeps ls a child of the shell.
  startShell(supervisor, "child",
             "grep SigIgn /proc/self/status; read line || echo no input; ls /proc/$$/fd; true");
  supervisor.wait(seconds(10));
  EXPECT_EQ(lastLines(folder_ + "/child", 10),
            (std::vector<std::string>{"SigIgn:\t0000000000000000", "no input", "0", "1", "2"}));
}

TEST_F(SupervisorTest, NamesTheProgramThatCannotBeRun) {
  Supervisor supervisor;
  try {
    supervisor.start({"x", folder_ + "/nothing", {}, folder_ + "/log"});
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_EQ(error.what(), "cannot run " + folder_ + "/nothing");
  }
  try {
    programOnPath("no-such-program", "some-package");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "no-such-program is missing: apt-get install some-package");
  }
  EXPECT_THROW(programBeside("no-such-program"), std::runtime_error);
}

TEST_F(SupervisorTest, AFolderOnPathThatCannotBeReadHidesNoOther) {
  const std::string loop = folder_ + "/loop", path = std::getenv("PATH");
  std::filesystem::create_symlink(loop, loop);
  setenv("PATH", (loop + ":" + path).c_str(), 1);
  EXPECT_NO_THROW(EXPECT_FALSE(programOnPath("sh", "dash").starts_with(loop)));
  setenv("PATH", path.c_str(), 1);
}

TEST_F(SupervisorTest, LastLinesAreTheLast) {
  std::ofstream(folder_ + "/log") << "1\n2\n3\n";
  EXPECT_EQ(lastLines(folder_ + "/log", 2), (std::vector<std::string>{"2", "3"}));
  EXPECT_EQ(lastLines(folder_ + "/log", 9).size(), 3u);
  EXPECT_TRUE(lastLines(folder_ + "/nothing", 2).empty());
}

}  // namespace
}  // namespace shoal::console
