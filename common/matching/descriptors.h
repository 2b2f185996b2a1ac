// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace shoal::matching {

/// One robot's topic as integers: sparse word weights. Only ratios within a descriptor matter.
struct Descriptor {
  struct Entry {
    int32_t word = 0;    ///< in [0, vocabulary size)
    int64_t weight = 0;  ///< > 0
    bool operator==(const Entry&) const = default;
  };
  int32_t slot = 0;            ///< the topic's id within its robot; ID matching joins equal slots
  std::vector<Entry> entries;  ///< ascending by word, each once; empty = an empty topic
  bool operator==(const Descriptor&) const = default;
};

/// The topics of all robots, in the canonical order the caller chose: robot by robot.
struct DescriptorSet {
  int32_t vocabulary_size = 0;
  std::vector<int32_t> group_first;  ///< first word of each word group, ascending, from 0; empty = one group
  std::vector<std::vector<Descriptor>> robots;
  bool operator==(const DescriptorSet&) const = default;
};

/// @throws std::invalid_argument naming the robot and topic, and what would be right: words ascending and
/// within the vocabulary, weights positive with a sum of at most 2^62, word groups ascending from 0.
void check(const DescriptorSet& topics);

}  // namespace shoal::matching
