// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "operator_console/mission_sources.h"
#include "shoal/mapping/held_pictures.h"

namespace shoal::console {

/// What labels look like as a finished run's folder says, pictures/pictures.json; none when it is missing.
/// @throws std::runtime_error naming the file when it is broken.
mapping::LabelPictures picturesOfRun(const std::string& dir);

/// The same of whom one asks: a node, a run or a recording. @throws as ask().
mapping::LabelPictures picturesAt(const Where& where);

/// Adds to each row of `labels` what is known of its pictures: robot, topic, example, when it was seen, how
/// many layers of how many are held, and of a finished run the file.
void addPictures(const Where& where, nlohmann::ordered_json& labels);

}  // namespace shoal::console
