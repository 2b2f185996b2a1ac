// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as camera.json: refused with a reason that names the file, or a camera that can be used.
//
//     fuzz_camera_file -max_total_time=60 -max_len=1024
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "shoal/world/camera_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    const auto camera =
        shoal::world::parseCamera(std::string(reinterpret_cast<const char*>(data), size), "given.json");
    const auto& k = camera.intrinsics;
    const bool sound = k.width > 0 && k.height > 0 && k.fx > 0 && k.fy > 0 && std::isfinite(k.cx + k.cy) &&
                       (!camera.depth_factor || *camera.depth_factor > 0) &&
                       (!camera.max_depth_m || *camera.max_depth_m > 0);
    if (!sound) std::abort();
  } catch (const std::invalid_argument& error) {
    if (std::string(error.what()).find("given.json") == std::string::npos) std::abort();
  }
  return 0;
}
