// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/export/geo_frame.h"
#include "shoal/mapping/queries.h"

namespace shoal::console {

/// The patches of all labels as GeoJSON. Without a frame as mapping::areasGeoJson(); with one as RFC 7946
/// wants it: longitude and latitude, WGS 84, in steps of 1e-9 degrees (0.1 mm).
std::string patchesGeoJson(const mapping::MissionView& view, const GeoFrame* frame);

/// A QGIS layer style for patchesGeoJson(): every label in its colour, called by its name. QGIS takes it for
/// map.geojson when it lies beside it as map.qml.
std::string patchesStyle(const mapping::MissionView& view);

/// The patches of all labels, a folder a label, and where robots were last heard, as KML 2.2: coloured
/// polygons on the ground.
std::string patchesKml(const mapping::MissionView& view, const GeoFrame& frame);

}  // namespace shoal::console
