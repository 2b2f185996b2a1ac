// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <functional>

namespace shoal::robot_agent {

/// Writes what a process holds at one moment while the process goes on: in a child that shares its memory as
/// it was then (fork, copy on write). To begin costs what it takes to copy the page tables, some milliseconds
/// a gigabyte; what is changed while the child lives is copied page by page.
///
/// One at a time. The child keeps no signal but SIGKILL, so that a Ctrl-C to the whole group does not end it,
/// is of low priority, and dies with the process that began it.
class BackgroundSave {
 public:
  BackgroundSave() = default;
  BackgroundSave(const BackgroundSave&) = delete;
  BackgroundSave& operator=(const BackgroundSave&) = delete;
  ~BackgroundSave();  ///< waits

  /// Runs `save` in a child; what it changes in memory stays there. It must not use other threads, nor what
  /// they may hold locked. Where no child can be made it runs here, and is done.
  /// Aborts while isRunning().
  /// @throws what `save` throws, when it runs here.
  void begin(const std::function<void()>& save);

  /// True from begin() until the child was seen to have ended.
  bool isRunning() const { return child_ > 0; }

  /// Looks whether the child has ended, or waits until it has. Nothing happens when none runs.
  /// @returns isRunning().
  /// @throws std::runtime_error with what `save` threw there, or that the child was killed.
  bool look() { return end(false); }
  void wait() { end(true); }

 private:
  bool end(bool waits);

  pid_t child_ = 0;
  int complaint_ = -1;  // pipe: what went wrong in the child
};

}  // namespace shoal::robot_agent
