// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "shoal/mapping/belief_store.h"
#include "shoal/mapping/global_map.h"
#include "shoal/mapping/judgement.h"
#include "shoal/mapping/map_tile.h"
#include "shoal/mapping/stacked_topics.h"
#include "shoal/matching/clustering.h"
#include "shoal/matching/matcher.h"

namespace shoal::mapping {

/// The fused map of a growing state, brought up to date at a cost in proportion to what has changed: tiles
/// (map_tile.h) in which no brick has come stay as they are, whatever the new matching says of labels, which
/// are a small table over the robots' topics.
///
/// What it shows is a function of the state and the options of the last update() alone: what came before,
/// and in how many steps, changes no byte.
class FusedMap {
 public:
  /// Brings the map up to date.
  /// @param beliefs  Always the same state, grown since; or a new FusedMap's first.
  /// @throws std::invalid_argument as matching::match() does for wrong options.
  /// Cost: O(robots) a tile that changed, the topics' words, and the matching when topics have changed.
  void update(const BeliefStore& beliefs, const matching::MatcherOptions& options);

  /// @name The map, as of the last update(). @{
  const std::vector<Correspondence>& correspondences() const { return correspondences_; }
  const std::vector<LabelSummary>& labels() const { return labels_; }
  uint64_t stateDigest() const { return state_digest_; }
  uint64_t digest() const { return digest_; }  ///< that of map(), but made of sums
  int64_t numCells() const { return num_cells_; }
  GlobalMap map() const;  ///< Cost: O(cells), in order without sorting.
  /// A hash of what each column of bricks shows, labels included; columns without cells are left out.
  /// Cost: O(tiles).
  std::map<BrickColumn, uint64_t> columnHashes() const;
  /// The cells of map() in these columns, in its order. Cost: O(their cells).
  std::vector<GlobalCell> cellsIn(const std::set<BrickColumn>& columns) const;
  /// @}

 private:
  using BrickIndex = std::array<int32_t, 3>;
  using RobotBrick = std::pair<world::RobotId, BrickIndex>;
  // A robot's cells in a brick by topic.
  using Spoken = std::vector<std::pair<world::TopicId, int64_t>>;
  // What a voice shows in all tiles.
  struct Shown {
    int64_t cells = 0;
    uint64_t hash = 0;
    std::map<world::Timestamp, int32_t> firsts;  // of its tiles, how often
  };

  // All that a matching looks at: while it is the same, so is the answer.
  struct Asked {
    matching::MatcherOptions options;
    std::vector<Voice> topics;
    std::vector<int32_t> vertex;
    matching::DescriptorSet descriptors;
    std::vector<TopicPair> links, apart;
    std::set<world::RobotId> excluded;
    bool operator==(const Asked&) const = default;
  };

  std::set<RobotBrick> changes(const BeliefStore& beliefs);
  void readBrick(const BeliefStore& beliefs, const RobotBrick& at, std::set<TileIndex>& touched);
  void exclude(const std::set<world::RobotId>& robots, std::set<TileIndex>& touched);
  void foldTile(const TileIndex& index, MapTile& tile);
  void countHeard(world::RobotId robot, const Spoken& spoken, int64_t sign);
  void matchAnew(const StackedTopics& stacked, const matching::MatcherOptions& options,
                 const Judgement& judgement);
  void relabel(const StackedTopics& stacked, const Judgement& judgement);
  std::vector<LabelSummary> summarize(const StackedTopics& stacked) const;

  uint64_t revision_ = 0;
  std::map<world::RobotId, int32_t> epochs_;
  std::map<RobotBrick, Spoken> spoken_;   // none empty
  std::map<Voice, int64_t> heard_cells_;  // of every robot's own map
  std::set<world::RobotId> excluded_;
  std::map<TileIndex, MapTile> tiles_;
  std::map<Voice, Shown> shown_;  // only those with cells
  LabelTable label_;

  std::optional<Asked> asked_;
  matching::Clustering clustering_;  // its answer
  matching::MatchMemory memory_;

  std::vector<Correspondence> correspondences_;
  std::vector<LabelSummary> labels_;
  uint64_t state_digest_ = 0, digest_ = 0;
  int64_t num_cells_ = 0;
};

}  // namespace shoal::mapping
