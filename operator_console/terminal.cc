// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/terminal.h"

#include <unistd.h>

#include <cstdio>

#include <spdlog/fmt/fmt.h>

namespace shoal::console {

bool isOnTerminal() { return ::isatty(STDOUT_FILENO) == 1; }

std::string alarming(const std::string& text) {
  return isOnTerminal() ? "\033[1;31m" + text + "\033[0m" : text;
}

std::string swatch(const Rgb& color) {
  if (!isOnTerminal()) return "";
  return fmt::format("\033[48;2;{};{};{}m  \033[0m", color[0], color[1], color[2]);
}

void clearTerminal() {
  if (isOnTerminal()) std::fputs("\033[H\033[2J", stdout);
}

}  // namespace shoal::console
