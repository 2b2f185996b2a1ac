// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/export/geo_frame.h"
#include "shoal/mapping/held_pictures.h"
#include "shoal/mapping/queries.h"

namespace shoal::console {

/// A mission as MCAP for Foxglove and Lichtblick; JSON in Foxglove's schemas, frame "mission", stamps are
/// mission time:
///   /map            PointCloud at the end: a point a cell, float32 x y z, uint8 red green blue alpha, int32
///   label,
///                   float32 certainty, uint16 robot, float32 age (seconds)
///   /tf             FrameTransform of every robot where it was last heard (places only: no turn is known)
///   /robots/R00     LocationFix of the same, with a frame on Earth only
///   /pictures/10004 CompressedImage (PNG) of what a label looks like, when it was seen
///   /events         Log
///   /status, /labels as `status --json` and `labels --json`, at the end
/// @param events  the answer to "events"; anything else counts as none.
std::string missionMcap(const mapping::MissionView& view, const mapping::LabelPictures& pictures,
                        const nlohmann::ordered_json& events, const GeoFrame* frame);

}  // namespace shoal::console
