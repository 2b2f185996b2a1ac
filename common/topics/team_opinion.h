// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "shoal/topics/label_counts.h"
#include "shoal/topics/team_topics.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// What the other robots of a team make of a cell that they have not seen, by the topics that they told: how
/// well it fits each label, and which label each of them would give it.
class TeamOpinion {
 public:
  /// What all of the others together add to the log2 weight of a label, when all would give it: bits. A team
  /// of n has n - 1 votes; each is worth a part of n.
  static constexpr int64_t kBitsOfAll = 8;

  /// A robot abstains when its best topic gives a word so many bits less than the best of all does: it knows
  /// nothing like that.
  static constexpr int64_t kBitsOfAStranger = 1;

  /// @param labels  the labels that count, from 0, by the team's numbers.
  TeamOpinion(const std::vector<world::WordGroup>& groups, double beta, const TeamTopics& team,
              const std::map<int32_t, int32_t>& labels);

  /// @param words            of the cell.
  /// @param num_words        how many they are.
  /// @param log_likelihoods  of each label, log2 in units of 2^-16: raised to what the best of the topics of
  ///                         that label gives.
  /// @param in_favour        Out: of each label, what votes add to the log2 of its weight, in units of 2^-16.
  ///                         A robot votes for the label of the topic that the words fit best, the first
  ///                         among equals; for none when that label does not count.
  /// Cost: words x topics additions.
  void ask(std::span<const world::WordCount> words, int64_t num_words, std::span<int64_t> log_likelihoods,
           std::span<int64_t> in_favour);

 private:
  struct Topic {
    int32_t robot = 0;   // from 0
    int32_t label = -1;  // -1: does not count
  };
  std::vector<Topic> topics_;
  std::vector<int32_t> choice_;  // by robot: its topic
  std::optional<LabelCounts> counts_;
  std::vector<int64_t> scores_;
};

}  // namespace shoal::topics
