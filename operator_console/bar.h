// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

namespace shoal::console {

/// One line of progress on stderr: "reef:sparse, repeats  [#####     ] 5 of 24, 3 min left". Nothing where
/// stderr is no terminal.
class Bar {
 public:
  explicit Bar(std::string what);
  ~Bar();
  Bar(const Bar&) = delete;
  Bar& operator=(const Bar&) = delete;

  /// From one thread at a time.
  void show(int64_t done, int64_t total);

 private:
  std::string what_;
  bool is_terminal_;
  int64_t first_ = -1;
  double started_s_ = 0, drawn_s_ = -1;
};

/// "42 s", "3 min", "1 h 20 min". Pure.
std::string duration(double seconds);

}  // namespace shoal::console
