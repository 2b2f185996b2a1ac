// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "shoal/mapping/held_pictures.h"
#include "shoal/mapping/queries.h"

namespace shoal::console {

/// Formats that a map is written in, as --format takes them.
const std::vector<std::string>& exportFormats();

/// What a file of that format is called: "map.ply".
std::string exportFileName(const std::string& format);

/// The map as a file's content. Coordinates are metres of the mission frame. The legend of a picture shows
/// `pictures` of labels.
/// @throws std::invalid_argument naming a format that is not one of exportFormats().
std::string exported(const mapping::MissionView& view, const std::string& format,
                     const mapping::LabelPictures& pictures = {});

}  // namespace shoal::console
