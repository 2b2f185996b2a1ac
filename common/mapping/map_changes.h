// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <utility>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/queries.h"

namespace shoal::mapping {

/// Tells a growing map again and again at the cost of what has changed: to {"query": "map", "has": DIGEST} it
/// answers as to
/// {"query": "map"}, with the map's "digest"; and when the map of that digest is among the last few that it
/// told, with "since": DIGEST and "blocks": [[x, y], ...], the squares of 64 x 64 columns that look different
/// since, and the cells of these alone.
class MapChanges {
 public:
  /// @param question  "has": sixteen hexadecimal digits, or "" for somebody who has nothing yet.
  /// @throws nlohmann::json::exception when "has" is no text.
  /// Cost: O(cells) hashes, text for the cells that are told.
  nlohmann::ordered_json answer(const MissionView& view, const nlohmann::ordered_json& question);

 private:
  using Block = std::pair<int32_t, int32_t>;
  struct Told {
    std::string digest;
    std::map<Block, uint64_t> blocks;
  };
  std::deque<Told> told_;  // the newest last
};

/// Brings a map up to date with an answer of MapChanges, or puts a whole one in its place. Correspondences
/// are not told.
/// @param map      what was told before; any other when the answer is whole.
/// @param origin   for error messages.
/// @returns the digest to ask with the next time; "" when the answerer knows nothing of changes.
/// @throws std::runtime_error or nlohmann::json::exception when the answer is none.
std::string takeChanges(GlobalMap& map, const nlohmann::ordered_json& answer, const std::string& origin);

}  // namespace shoal::mapping
