// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string_view>

namespace shoal::console {

/// JSON schemas of the messages foxglove.PointCloud, ... that Foxglove and Lichtblick know how to show.
extern const std::string_view kPointCloudSchema, kFrameTransformSchema, kCompressedImageSchema,
    kLocationFixSchema, kLogSchema;

}  // namespace shoal::console
