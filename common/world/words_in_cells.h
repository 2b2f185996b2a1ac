// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shoal/world/ids.h"

namespace shoal::world {

/// One kind of visual word: a contiguous range of word ids with a vocabulary of its own.
struct WordGroup {
  std::string name;   ///< e.g. "orb", "hue", "intensity"
  int32_t first = 0;  ///< first word id of the group
  int32_t size = 0;   ///< number of words, > 0
  bool operator==(const WordGroup&) const = default;
};

struct WordCount {
  int32_t word = 0;   ///< in [0, vocabulary size)
  int32_t count = 0;  ///< > 0
  auto operator<=>(const WordCount&) const = default;
};

/// The words that one image put into one cell.
struct CellWords {
  CellIndex cell;
  std::vector<WordCount> words;  ///< ascending by word, each once
};

/// What vision hands to topics: one image as words in cells of the map.
struct WordsInCells {
  int32_t observation = 0;  ///< number of the image
  Timestamp time;
  std::vector<CellWords> cells;  ///< ascending by cell, each once, none empty
  int64_t dropped_words = 0;     ///< words without a valid depth
};

}  // namespace shoal::world
