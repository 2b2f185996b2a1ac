// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "shoal/mapping/held_pictures.h"

namespace shoal::console {

/// A finished mission as its summary tells it.
struct MissionSummary {
  nlohmann::ordered_json facts;   ///< summary.json
  nlohmann::ordered_json labels;  ///< rows as `labels --json` has them, largest area first
  double area_m2 = 0;             ///< of all labels
  nlohmann::ordered_json surprises =
      nlohmann::ordered_json::array();             ///< places as `surprises --json` has them
  mapping::LabelPictures pictures;                 ///< what labels look like
  std::string map_png;                             ///< the map as it is now, in the colours of labels
  std::string truth_png;                           ///< bytes of global_map.png; empty when it is missing
  std::optional<nlohmann::ordered_json> verified;  ///< `verify --json` of the recording; none without one
};

/// Reads a finished mission's folder; its recording is verified when it has one.
/// @throws std::runtime_error naming what is missing or broken.
MissionSummary readSummaryOf(const std::string& run);

/// One page of HTML that needs nothing else: pictures are in it. Pure.
std::string summaryHtml(const MissionSummary& mission);

/// The same in plain text, what matters most first, in at most `max_bytes` bytes: whole lines, as many as
/// fit. Pure. @throws std::invalid_argument below 80 bytes.
std::string summaryText(const MissionSummary& mission, size_t max_bytes);

}  // namespace shoal::console
