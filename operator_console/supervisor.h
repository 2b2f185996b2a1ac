// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <chrono>
#include <cstddef>
#include <string>
#include <vector>

namespace shoal::console {

/// A program to run.
struct Command {
  std::string name;     ///< what people call it: "R03"
  std::string program;  ///< path of the executable
  std::vector<std::string> arguments;
  std::string log;       ///< file that gets its stdout and stderr; made anew ...
  bool goes_on = false;  ///< ... unless the program has been running before
};

/// A child that is no more.
struct Ended {
  std::string name;
  std::string log;
  int status = 0;  ///< as waitpid() says

  bool inGoodOrder() const;  ///< exited with 0
  bool crashed() const;      ///< ended by a signal
  std::string how() const;   ///< "exited with code 1", "was killed by signal 11 (Segmentation fault)"
};

/// Runs programs that must not outlive this process, whatever ends it: the kernel kills them (SIGKILL) when
/// the thread that started them ends, so start() belongs into the main thread. Each has a process group of
/// its own, so Ctrl-C reaches this process alone, which then ends them in good order; stdin is empty.
class Supervisor {
 public:
  Supervisor() = default;
  ~Supervisor();  ///< kills what still runs, and waits for it
  Supervisor(const Supervisor&) = delete;
  Supervisor& operator=(const Supervisor&) = delete;

  /// @throws std::runtime_error naming the program that cannot be run or the log that cannot be written.
  void start(const Command& command);

  /// Those that have ended since the last call, in the order of their starting. Never blocks.
  std::vector<Ended> reap();

  /// Sends a signal to those named so, or to all.
  void signal(const std::string& name, int signal);
  void signalAll(int signal);

  /// Waits until all have ended, or as long as `patience` lasts. Returns those that ended meanwhile.
  std::vector<Ended> wait(std::chrono::milliseconds patience);

  /// SIGTERM; SIGKILL for those that are still there after `patience`. Nothing runs afterwards.
  std::vector<Ended> stopAll(std::chrono::milliseconds patience);

  size_t numRunning() const { return running_.size(); }
  bool isRunning(const std::string& name) const;
  pid_t pidOf(const std::string& name) const;  ///< 0 when it does not run

 private:
  struct Child {
    pid_t pid;
    std::string name;
    std::string log;
  };
  std::vector<Child> running_;
};

/// The program of that name beside this one (/proc/self/exe).
/// @throws std::runtime_error naming the path when there is none that can be run.
std::string programBeside(const std::string& name);

/// The program of that name on PATH.
/// @throws std::runtime_error saying which Debian package has it.
std::string programOnPath(const std::string& name, const std::string& package);

/// The last lines of a text file, at most `count` and 16 kB; empty when it cannot be read.
std::vector<std::string> lastLines(const std::string& path, size_t count);

}  // namespace shoal::console
