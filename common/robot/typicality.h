// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "shoal/mapping/local_belief.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::robot {

/// How typical the words of one cell are of a topic, next to the robot's other topics.
///
/// The cosine between the roots of the cell's word frequencies and the topic's discounted profile: of each
/// word the root of its frequency in the topic, less half the root of its frequency in all topics together,
/// not below 0. Roots make it an affinity of distributions (Bhattacharyya 1943); the discount leaves out what
/// every topic has. A cell with few words is far from any topic.
class Typicality {
 public:
  /// Cost: a pass over the topics' words. @param belief  its topics and word groups.
  explicit Typicality(const mapping::LocalBelief& belief);

  /// In [0, kMost]. @param words  ascending by word, inside the vocabulary. 0 for a topic that is not there
  /// and for no words.
  int32_t of(const std::vector<world::WordCount>& words, world::TopicId topic) const;

  static constexpr int32_t kMost = 1 << 16;

 private:
  std::map<world::TopicId, std::vector<float>> profile_;  // unit length, by word
};

}  // namespace shoal::robot
