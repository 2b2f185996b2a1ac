// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/word_extractor.h"

#include <stdexcept>

#include "shoal/vision/dense_vocabulary.h"
#include "shoal/vision/dense_words.h"
#include "shoal/vision/paper_words.h"
#include "shoal/vision/shipped_vocabulary.h"
#include "shoal/vision/vocabulary.h"

namespace shoal::vision {

void WordExtractor::resume(std::span<const int64_t> learnt) {
  if (!learnt.empty()) {
    throw std::invalid_argument("these words learn nothing from images, got " +
                                std::to_string(learnt.size()) + " numbers");
  }
}

std::unique_ptr<WordExtractor> makeWordExtractor(const std::string& profile) {
  return makeWordExtractor(profile, profile == "best" ? shippedDenseVocabulary() : shippedOrbVocabulary());
}

std::unique_ptr<WordExtractor> makeWordExtractor(const std::string& profile,
                                                 std::span<const uint8_t> vocabulary_bytes) {
  if (profile == "paper") return std::make_unique<PaperWords>(Vocabulary::parse(vocabulary_bytes));
  if (profile == "best") return std::make_unique<DenseWords>(DenseVocabulary::parse(vocabulary_bytes));
  throw std::invalid_argument("no profile \"" + profile + "\"; use \"paper\" or \"best\"");
}

}  // namespace shoal::vision
