// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/terminal.h"

#include <unistd.h>

#include <algorithm>
#include <cstdint>
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

std::string shortened(const std::string& text, size_t width) {
  const auto begins = [](char c) { return (static_cast<uint8_t>(c) & 0xc0) != 0x80; };  // a code point
  const auto columns = static_cast<size_t>(std::ranges::count_if(text, begins));
  if (columns <= width) return text + std::string(width - columns, ' ');
  size_t end = 0;
  for (size_t seen = 0; end < text.size(); ++end) {
    if (begins(text[end]) && ++seen == width) break;
  }
  return text.substr(0, end) + "~";
}

std::string column(const std::string& text, size_t width) {
  if (isOnTerminal()) return shortened(text, width);
  const std::string fitted = shortened(text, width);
  return fitted.ends_with('~') ? text : fitted;
}

std::string lastColumn(const std::string& text, size_t width) {
  std::string last = column(text, width);
  last.erase(last.find_last_not_of(' ') + 1);
  return last;
}

void clearTerminal() {
  if (isOnTerminal()) std::fputs("\033[H\033[2J", stdout);
}

}  // namespace shoal::console
