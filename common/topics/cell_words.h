// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// One word seen in a cell, and the topic it is assigned to: the z_i of the model.
struct Token {
  int32_t word = 0;
  int32_t slot = -1;  ///< place of its topic in the count tables; -1 before the first draw
};

/// One cell of the map as the model keeps it. Never empty, never forgotten.
struct Cell {
  world::CellIndex index;
  std::vector<Token> tokens;     ///< in order of arrival; a later image appends
  uint32_t num_draws = 0;        ///< how often it was given random numbers: names its next stream
  float surprise = 0;            ///< the most at any sight: see SurpriseScale
  int32_t seen_observation = 0;  ///< last image that put words here
  world::Timestamp seen;
};

/// @throws std::invalid_argument naming what breaks the contract of WordsInCells: cells or words out of
///         order or twice, an empty cell, a word outside [0, vocabulary_size), a count below 1, more than
///         10 million words in one image.
void check(const world::WordsInCells& words, int32_t vocabulary_size);

/// The same words, one token each, ascending by word, without topics.
std::vector<Token> tokens(const world::CellWords& words);

}  // namespace shoal::topics
