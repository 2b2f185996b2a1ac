// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/camera_channels.h"

#include <algorithm>
#include <cctype>
#include <stdexcept>

#include "shoal/comms/channels.h"

namespace shoal::comms {

CameraChannels::CameraChannels(const std::string& prefix)
    : image(prefix + "_IMAGE"),
      depth(prefix + "_DEPTH"),
      images(prefix + "_IMAGES"),
      pose(prefix + "_POSE"),
      vehicle(prefix + "_STATUS") {
  const auto plain = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  const bool good = !prefix.empty() && images.size() <= kMaxChannelLength &&
                    std::ranges::all_of(prefix, plain) && !prefix.starts_with("SHOAL_");
  if (!good) {
    throw std::invalid_argument("the cameras' prefix \"" + prefix +
                                "\" should be 1 to 56 letters, digits and underscores, and not begin with "
                                "SHOAL_, as in lcm:CAM");
  }
}

}  // namespace shoal::comms
