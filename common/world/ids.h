// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <compare>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "shoal/random.h"

namespace shoal::world {

/// Robots are R00, R01, ...; the number is what orders them.
enum class RobotId : int32_t {};

/// A robot's own topic. In [0, kMaxTopicId], never reused within a mission.
enum class TopicId : int32_t {};
inline constexpr int32_t kMaxTopicId = 9999;

/// A label all robots agree on: robot x 10000 + topic of the oldest topic of its cluster.
enum class GlobalLabel : int32_t {};

constexpr int32_t number(RobotId id) { return static_cast<int32_t>(id); }
constexpr int32_t number(TopicId id) { return static_cast<int32_t>(id); }
constexpr int32_t number(GlobalLabel id) { return static_cast<int32_t>(id); }

constexpr GlobalLabel globalLabel(RobotId robot, TopicId topic) {
  return GlobalLabel{number(robot) * 10000 + number(topic)};
}

/// "R03", at least two digits.
std::string name(RobotId robot);

/// The inverse of name(): "R" and 2 to 4 digits; nothing else, and nothing above R9999.
std::optional<RobotId> parseRobotId(std::string_view text);

/// Mission time, microseconds. Frame n of a flown source is at n x frame period.
struct Timestamp {
  int64_t us = 0;
  auto operator<=>(const Timestamp&) const = default;
  double seconds() const { return static_cast<double>(us) * 1e-6; }
};

/// How new a piece of state is: the observation number (0-based) at which its content last changed,
/// within an epoch that grows when a robot has lost its disk. Equal versions are equal bytes.
struct Version {
  int32_t epoch = 0;
  int32_t observation = 0;
  auto operator<=>(const Version&) const = default;
};

/// A cell of the map, centred at index x cell size in the world frame.
struct CellIndex {
  int32_t x = 0, y = 0, z = 0;
  auto operator<=>(const CellIndex&) const = default;
};

struct CellHash {
  size_t operator()(const CellIndex& c) const {
    return mix64(mix64(mix64(static_cast<uint32_t>(c.x)) ^ static_cast<uint32_t>(c.y)) ^
                 static_cast<uint32_t>(c.z));
  }
};

}  // namespace shoal::world
