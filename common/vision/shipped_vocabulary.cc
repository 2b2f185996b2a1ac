// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/shipped_vocabulary.h"

#include <cstddef>

// The assembler copies a file between two symbols; CMake tells its path and rebuilds this when it changes.
#define SHOAL_INCLUDE_FILE(symbol, file) \
  asm(".pushsection .rodata\n"           \
      ".balign 8\n" symbol               \
      ":\n"                              \
      ".incbin \"" file "\"\n" symbol    \
      "_end:\n"                          \
      ".balign 8\n" symbol               \
      "_size:\n"                         \
      ".quad " symbol "_end - " symbol   \
      "\n"                               \
      ".global " symbol                  \
      "\n"                               \
      ".global " symbol                  \
      "_size\n"                          \
      ".popsection\n")

SHOAL_INCLUDE_FILE("shoal_orb_vocabulary", SHOAL_ORB_VOCABULARY_FILE);
SHOAL_INCLUDE_FILE("shoal_dense_vocabulary", SHOAL_DENSE_VOCABULARY_FILE);

extern "C" {
extern const uint8_t shoal_orb_vocabulary[];
extern const uint64_t shoal_orb_vocabulary_size;
extern const uint8_t shoal_dense_vocabulary[];
extern const uint64_t shoal_dense_vocabulary_size;
}

namespace shoal::vision {

std::span<const uint8_t> shippedOrbVocabulary() {
  return {shoal_orb_vocabulary, static_cast<size_t>(shoal_orb_vocabulary_size)};
}

std::span<const uint8_t> shippedDenseVocabulary() {
  return {shoal_dense_vocabulary, static_cast<size_t>(shoal_dense_vocabulary_size)};
}

}  // namespace shoal::vision
