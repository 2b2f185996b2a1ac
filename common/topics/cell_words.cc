// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/cell_words.h"

#include <stdexcept>
#include <string>

namespace shoal::topics {
namespace {

constexpr int64_t kMaxWordsInImage = 10'000'000;

std::string text(const world::CellIndex& c) {
  return "cell (" + std::to_string(c.x) + ", " + std::to_string(c.y) + ", " + std::to_string(c.z) + ")";
}

}  // namespace

void check(const world::WordsInCells& words, int32_t vocabulary_size) {
  int64_t total = 0;
  for (size_t i = 0; i < words.cells.size(); ++i) {
    const auto& [cell, counts] = words.cells[i];
    if (i > 0 && !(words.cells[i - 1].cell < cell)) {
      throw std::invalid_argument("cells must ascend, each once; " + text(cell) + " does not");
    }
    if (counts.empty()) throw std::invalid_argument(text(cell) + " must hold at least one word, got none");
    int32_t previous = -1;
    for (const auto& [word, count] : counts) {
      if (word < 0 || word >= vocabulary_size) {
        throw std::invalid_argument("words must lie in [0, " + std::to_string(vocabulary_size) + "), got " +
                                    std::to_string(word) + " in " + text(cell));
      }
      if (word <= previous) {
        throw std::invalid_argument("words of " + text(cell) + " must ascend, each once; word " +
                                    std::to_string(word) + " does not");
      }
      if (count < 1) {
        throw std::invalid_argument("the count of word " + std::to_string(word) + " in " + text(cell) +
                                    " must be at least 1, got " + std::to_string(count));
      }
      previous = word;
      total += count;
    }
  }
  if (total > kMaxWordsInImage) {
    throw std::invalid_argument("an image must hold at most " + std::to_string(kMaxWordsInImage) +
                                " words, got " + std::to_string(total));
  }
}

std::vector<Token> tokens(const world::CellWords& words) {
  std::vector<Token> tokens;
  for (const auto& [word, count] : words.words)
    tokens.insert(tokens.end(), static_cast<size_t>(count), {word});
  return tokens;
}

}  // namespace shoal::topics
