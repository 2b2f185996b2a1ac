// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a message of a ROS 2 bag, and as an MCAP file: refused, or values within their bounds. The
// first byte says as what.
//
//     fuzz_bag -max_total_time=60 $(mktemp -d) tests/fuzz/corpus/bag
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <sstream>
#include <stdexcept>
#include <string>

#include "operator_console/bag/bag_reader.h"
#include "operator_console/bag/ros_messages.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace shoal::console;  // NOLINT: a harness
  if (size == 0) return 0;
  const std::span<const uint8_t> bytes(data + 1, size - 1);
  std::string trouble;
  const auto check = [&](bool read) {
    if (read != trouble.empty()) std::abort();
  };
  switch (data[0] % 6) {
    case 0:
    case 1: {
      const auto picture = readImage(bytes, data[0] % 6 == 1, trouble);
      check(picture.has_value());
      if (picture && (picture->pixels.empty() || picture->pixels.cols > 8192)) std::abort();
      break;
    }
    case 2:
      check(readCameraInfo(bytes, trouble).has_value());
      break;
    case 3:
    case 4: {
      const auto pose = readPose(bytes, data[0] % 6 == 3, trouble);
      check(pose.has_value());
      if (pose && pose->stamp.us < 0) std::abort();
      break;
    }
    default: {
      std::istringstream in(std::string(bytes.begin(), bytes.end()));
      try {
        readMcap(in, "a.mcap", [](const BagMessage& message) {
          if (message.data.size() > (size_t{1} << 28)) std::abort();
        });
      } catch (const std::runtime_error&) {
      }
    }
  }
  return 0;
}
