// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/bar.h"

#include <unistd.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include <spdlog/fmt/fmt.h>

namespace shoal::console {
namespace {

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

Bar::Bar(std::string what)
    : what_(std::move(what)), is_terminal_(isatty(STDERR_FILENO) == 1), started_s_(now()) {}

Bar::~Bar() {
  if (is_terminal_ && drawn_s_ >= 0) std::fputs("\r\033[K", stderr);
}

void Bar::show(int64_t done, int64_t total) {
  if (!is_terminal_ || total <= 0) return;
  if (first_ < 0) first_ = done;
  const double t = now();
  if (drawn_s_ >= 0 && t - drawn_s_ < 0.2 && done < total) return;
  drawn_s_ = t;
  constexpr int kWidth = 24;
  const int filled = static_cast<int>(kWidth * done / total);
  std::string line = fmt::format("\r\033[K{:<34.34} [{:#<{}}{:<{}}] {} of {}", what_, "", filled, "",
                                 kWidth - filled, done, total);
  if (done > first_) {
    line +=
        ", " +
        duration((t - started_s_) * static_cast<double>(total - done) / static_cast<double>(done - first_)) +
        " left";
  }
  std::fputs(line.c_str(), stderr);
  std::fflush(stderr);
}

std::string duration(double seconds) {
  const auto s = static_cast<int64_t>(std::llround(seconds));
  if (s < 120) return fmt::format("{} s", s);
  if (s < 7200) return fmt::format("{} min", (s + 30) / 60);
  return fmt::format("{} h {} min", s / 3600, s % 3600 / 60);
}

}  // namespace shoal::console
