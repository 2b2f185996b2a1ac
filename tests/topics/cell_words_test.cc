// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/cell_words.h"

#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace shoal::topics {
namespace {

using world::CellWords;
using world::WordsInCells;

WordsInCells image(std::vector<CellWords> cells) { return {.time = {}, .cells = std::move(cells)}; }

TEST(CellWordsTest, ACountBecomesThatManyTokens) {
  std::vector<int32_t> words;
  for (const Token& token : tokens({{}, {{2, 3}, {7, 1}}})) {
    words.push_back(token.word);
    EXPECT_EQ(token.slot, -1);
  }
  EXPECT_EQ(words, (std::vector{2, 2, 2, 7}));
}

TEST(CellWordsTest, AcceptAnEmptyImageAndEveryWordOfTheVocabulary) {
  EXPECT_NO_THROW(check(image({}), 1));
  EXPECT_NO_THROW(check(image({{{-1, 0, 0}, {{0, 1}, {9, 2}}}, {{0, 0, 0}, {{0, 1}}}}), 10));
}

TEST(CellWordsTest, RejectWhatBreaksTheContract) {
  const int32_t many = std::numeric_limits<int32_t>::max();
  for (const WordsInCells& bad : {
           image({{{1, 0, 0}, {{0, 1}}}, {{0, 0, 0}, {{0, 1}}}}),  // cells descend
           image({{{1, 0, 0}, {{0, 1}}}, {{1, 0, 0}, {{0, 1}}}}),  // a cell twice
           image({{{0, 0, 0}, {}}}),                               // a cell without words
           image({{{0, 0, 0}, {{-1, 1}}}}),                        // a word below the vocabulary
           image({{{0, 0, 0}, {{10, 1}}}}),                        // and above it
           image({{{0, 0, 0}, {{4, 1}, {3, 1}}}}),                 // words descend
           image({{{0, 0, 0}, {{4, 1}, {4, 1}}}}),                 // a word twice
           image({{{0, 0, 0}, {{4, 0}}}}),                         // counted zero times
           image({{{0, 0, 0}, {{4, many}}}}),                      // more than memory holds
       }) {
    EXPECT_THROW(check(bad, 10), std::invalid_argument);
  }
}

TEST(CellWordsTest, RejectionsNameTheCellAndTheWord) {
  try {
    check(image({{{-3, 4, 0}, {{10, 1}}}}), 10);
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "words must lie in [0, 10), got 10 in cell (-3, 4, 0)");
  }
}

}  // namespace
}  // namespace shoal::topics
