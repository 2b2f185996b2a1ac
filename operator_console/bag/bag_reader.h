// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <istream>
#include <span>
#include <string>
#include <vector>

namespace shoal::console {

/// A message of a ROS 2 bag. Valid while it is looked at.
struct BagMessage {
  const std::string& topic;
  const std::string& type;        ///< "sensor_msgs/msg/Image"
  std::span<const uint8_t> data;  ///< CDR
};
using OnBagMessage = std::function<void(const BagMessage&)>;

/// Calls for every message in CDR of a bag, in the order in which it stands there: a .db3 (SQLite) or .mcap
/// file, or the folder of a bag with any of them, by name.
/// @throws std::runtime_error naming a file that cannot be read, or is no bag, and why.
void readBag(const std::string& path, const OnBagMessage& on_message);

/// The same of MCAP bytes (https://mcap.dev/spec), chunks uncompressed or zstd. A file that was cut off is
/// read as far as it goes. Any bytes may come. @param name  for errors. @throws std::runtime_error.
void readMcap(std::istream& in, const std::string& name, const OnBagMessage& on_message);

}  // namespace shoal::console
