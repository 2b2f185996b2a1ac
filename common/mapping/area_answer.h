// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/patches.h"
#include "shoal/mapping/queries.h"

namespace shoal::mapping {

/// The label of that number or name, when the map has it. A name that two labels share names neither.
std::optional<world::GlobalLabel> labelNamed(const GlobalMap& map, const std::string& text);

/// What to say of a label that is not there: names some that are.
std::string noSuchLabel(const GlobalMap& map, const std::string& text);

/// The answer to `area LABEL`: the patches of the label with their outlines. Lengths in metres of the mission
/// frame with 3 decimals, times in seconds of mission time. {"error": ...} when the map has no such label.
/// @throws std::invalid_argument as patchesOf().
nlohmann::ordered_json areaAnswer(const MissionView& view, const std::string& label,
                                  const PatchFilter& filter);

/// The whole map as such patches: a list of areaAnswer(), ascending by label.
nlohmann::ordered_json areasOf(const MissionView& view);

/// An area's patches as CSV, a row a patch, numbered from 1:
/// label,name,patch,area_m2,cells,x_m,y_m,min_x_m,min_y_m,max_x_m,max_y_m,robots,first_seen_s,last_seen_s,
/// certainty. @param area  an areaAnswer().
std::string areaCsv(const nlohmann::ordered_json& area);

/// Areas as one GeoJSON FeatureCollection, a feature a patch: Polygon, or MultiPolygon where cells meet at
/// corners only. Coordinates are metres of the mission frame, not degrees; the member "coordinates_are" says
/// so. @param areas  a list of areaAnswer().
nlohmann::ordered_json areasGeoJson(const nlohmann::ordered_json& areas);

}  // namespace shoal::mapping
