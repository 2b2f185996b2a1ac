// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/label_census.h"

namespace shoal::mapping {

/// A map that is told in pieces: FusedMap has one at hand.
struct MapInColumns {
  double cell_size_m = 1;
  uint64_t digest = 0;
  const std::vector<LabelSummary>& labels;
  std::map<BrickColumn, uint64_t> hashes;  ///< of what each column of bricks shows; none for empty ones
  std::function<std::vector<GlobalCell>(const std::set<BrickColumn>&)> cells_in;  ///< ascending by cell
  /// What surprised in these cells: ToldSurprises::of().
  std::function<std::vector<uint8_t>(std::span<const GlobalCell>)> surprises_of;
};

/// Tells a growing map again and again at the cost of what has changed: to {"query": "map", "has": DIGEST} it
/// answers as to {"query": "map"}, with the map's "digest" and the rows of {"query": "labels"}; and when the
/// map of that digest is among the last few that it told, with "since": DIGEST and "columns": [[x, y], ...],
/// the squares of 16 x 16 columns that look different since, and the cells of these alone. "surprises": [[row
/// of the cells, steps of 1 / kSurpriseStepsPerUnit], ...], for those cells that surprised.
class MapChanges {
 public:
  /// @param question  "has": sixteen hexadecimal digits, or "" for somebody who has nothing yet.
  /// @throws nlohmann::json::exception when "has" is no text.
  /// Cost: O(columns of bricks); O(cells) for those that changed since the last question, and that are told.
  nlohmann::ordered_json answer(const MapInColumns& map, const nlohmann::ordered_json& question);

 private:
  struct Told {
    std::string digest;
    std::map<BrickColumn, uint64_t> hashes;
  };
  struct Counted {
    uint64_t hash = 0;
    LabelCensus census;
  };
  void count(const MapInColumns& map);

  std::deque<Told> told_;                   // the newest last
  std::map<BrickColumn, Counted> counted_;  // of the map that was asked for last
};

/// What an answer of MapChanges says.
struct MapChange {
  std::string digest;    ///< to ask with the next time; "" when the answerer knows nothing of changes
  bool is_whole = true;  ///< `part` is all of the map
  std::set<BrickColumn>
      columns;     ///< else: those that `part` holds the cells of, and nothing where it has none
  GlobalMap part;  ///< labels are always whole; correspondences are not told
  std::vector<uint8_t> surprises;  ///< of part.cells, as ToldSurprises::of(); empty: nothing is known
};

/// Reads an answer. @param origin  for error messages.
/// @throws std::runtime_error or nlohmann::json::exception when the answer is none.
MapChange readChange(const nlohmann::ordered_json& answer, const std::string& origin);

}  // namespace shoal::mapping
