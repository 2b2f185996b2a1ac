// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shoal/wire/heartbeat_codec.h"

namespace shoal::console {

/// How a mission gets on, as a person wants to see it.
struct MissionProgress {
  int num_robots = 0;
  int32_t observations = 0;  ///< planned per robot by the command line; 0 = the robots say
  double elapsed_s = 0;      ///< wall time since the start
  std::string doing;         ///< "flying", "settling", ...
  const std::map<std::string, wire::Heartbeat>* nodes = nullptr;
};

/// The lines to show in `width` columns and `height` rows: robots (frames, topics, bytes sent) side by side
/// as they fit, left out when they do not, and one bar for all with the time it will take. Pure.
std::vector<std::string> progressLines(const MissionProgress& progress, size_t width, size_t height);

/// What takes the last `lines` lines away from a terminal, wherever in the line below them it stands.
std::string erasing(size_t lines);

/// Draws lines over those drawn before, on stderr. When that is no terminal, says the bar's line once a
/// minute.
class TerminalBlock {
 public:
  TerminalBlock();

  bool isTerminal() const { return is_terminal_; }
  void draw(const MissionProgress& progress);
  /// Takes the lines away, so that a log line can be written.
  void clear();

 private:
  bool is_terminal_;
  size_t drawn_ = 0;
  double said_s_ = 0;  // elapsed when the bar's line was said
};

}  // namespace shoal::console
