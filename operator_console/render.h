// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/held_pictures.h"
#include "shoal/world/grid.h"
#include "shoal/world/world.h"

namespace shoal::console {

using Rgb = std::array<uint8_t, 3>;

/// The colour of a label: always the same, whatever else is on the map.
Rgb colorOf(world::GlobalLabel label);

/// The colour of a robot's track, as the page of serve has it.
Rgb robotColor(world::RobotId robot);

/// The truth to draw beside a map.
struct TruthPicture {
  std::vector<world::TruthClass> classes;
  std::function<std::optional<int>(const world::CellIndex&)> of_cell;
};

/// Colours for a map drawn beside its truth, for display only: labels are paired with the classes they
/// overlap most (optimal assignment, one label a class) and take their colours; other labels keep colorOf().
std::map<world::GlobalLabel, Rgb> alignedColors(const mapping::GlobalMap& map, const TruthPicture& truth);

/// What labels look like, square, BGR, for the legend.
using LegendPictures = std::map<world::GlobalLabel, cv::Mat>;
LegendPictures legendPictures(const mapping::LabelPictures& pictures);

/// Draws the map from above, north (+Y) up, the highest cell of each column, with a legend of the largest
/// labels, their pictures beside them, and the truth beside it when given. An empty map gives a picture that
/// says so.
/// @returns BGR, CV_8UC3. Pure.
cv::Mat render(const mapping::GlobalMap& map, const world::Grid& grid, const std::string& title,
               const std::optional<TruthPicture>& truth = {}, const LegendPictures& pictures = {});

/// PNG bytes of a picture.
std::string encodePng(const cv::Mat& picture);

}  // namespace shoal::console
