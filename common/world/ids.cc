// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/ids.h"

namespace shoal::world {

std::string name(RobotId robot) {
  const std::string digits = std::to_string(number(robot));
  return (digits.size() < 2 ? "R0" : "R") + digits;
}

std::optional<RobotId> parseRobotId(std::string_view text) {
  if (text.size() < 3 || text.size() > 5 || text[0] != 'R') return std::nullopt;
  int32_t value = 0;
  for (const char c : text.substr(1)) {
    if (c < '0' || c > '9') return std::nullopt;
    value = value * 10 + (c - '0');
  }
  if (name(RobotId{value}) != text) return std::nullopt;  // "R003" is not a name
  return RobotId{value};
}

}  // namespace shoal::world
