// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/background_save.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <exception>
#include <stdexcept>
#include <string>

#include "shoal/demand.h"

namespace shoal::robot_agent {
namespace {

constexpr int kNice = 10;
constexpr size_t kMostComplaint = 4000;  // a pipe takes as much at once

[[noreturn]] void saveAndExit(const std::function<void()>& save, pid_t parent, int complaint) {
  std::signal(SIGINT, SIG_IGN);
  std::signal(SIGTERM, SIG_IGN);
  std::signal(SIGHUP, SIG_IGN);
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(1);  // it died before that
  if (::nice(kNice) < 0) {                // then at the usual priority
  }
  try {
    save();
  } catch (const std::exception& error) {
    const std::string what = std::string(error.what()).substr(0, kMostComplaint);
    if (::write(complaint, what.data(), what.size()) < 0) ::_exit(2);
    ::_exit(1);
  }
  ::_exit(0);
}

std::string readAll(int pipe) {
  std::string text;
  std::array<char, 512> buffer;
  for (ssize_t n = 0; (n = ::read(pipe, buffer.data(), buffer.size())) > 0 || (n < 0 && errno == EINTR);) {
    if (n > 0) text.append(buffer.data(), static_cast<size_t>(n));
  }
  return text;
}

}  // namespace

BackgroundSave::~BackgroundSave() {
  try {
    wait();
  } catch (const std::exception&) {  // nobody is left to be told
  }
}

void BackgroundSave::begin(const std::function<void()>& save) {
  SHOAL_DEMAND(!isRunning());
  std::array<int, 2> ends{-1, -1};
  if (::pipe2(ends.data(), O_CLOEXEC) != 0) return save();
  const pid_t parent = ::getpid();
  const pid_t child = ::fork();
  if (child == 0) saveAndExit(save, parent, ends[1]);
  ::close(ends[1]);
  if (child < 0) {
    ::close(ends[0]);
    return save();
  }
  child_ = child;
  complaint_ = ends[0];
}

bool BackgroundSave::end(bool waits) {
  if (child_ == 0) return false;
  int status = 0;
  pid_t ended = 0;
  do ended = ::waitpid(child_, &status, waits ? 0 : WNOHANG);
  while (ended < 0 && errno == EINTR);
  if (ended == 0) return true;
  const std::string complaint = readAll(complaint_);
  ::close(complaint_);
  child_ = 0;
  if (ended < 0 || !WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(complaint.empty() ? "the process that saves was killed" : complaint);
  return false;
}

}  // namespace shoal::robot_agent
