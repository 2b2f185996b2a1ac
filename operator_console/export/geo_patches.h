// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <map>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/export/geo_frame.h"
#include "operator_console/robot_tracks.h"
#include "shoal/mapping/queries.h"

namespace shoal::console {

/// The patches of all labels as GeoJSON. Without a frame as mapping::areasGeoJson(); with one as RFC 7946
/// wants it: longitude and latitude, WGS 84, in steps of 1e-9 degrees (0.1 mm).
std::string patchesGeoJson(const mapping::MissionView& view, const GeoFrame* frame);

/// A QGIS layer style for patchesGeoJson(): every label in its colour, called by its name. QGIS takes it for
/// map.geojson when it lies beside it as map.qml.
std::string patchesStyle(const mapping::MissionView& view);

/// The patches of all labels, a folder a label, where robots were last heard, and their tracks, as KML 2.2:
/// coloured polygons on the ground, lines at their height above it.
std::string patchesKml(const mapping::MissionView& view,
                       const std::map<std::string, std::vector<TrackPoint>>& tracks, const GeoFrame& frame);

}  // namespace shoal::console
