// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/shipped_vocabulary.h"

#include <cstddef>

// The assembler copies the file; CMake tells its path and rebuilds this when it changes.
asm(".pushsection .rodata\n"
    ".balign 8\n"
    "shoal_orb_vocabulary:\n"
    ".incbin \"" SHOAL_ORB_VOCABULARY_FILE
    "\"\n"
    "shoal_orb_vocabulary_end:\n"
    ".balign 8\n"
    "shoal_orb_vocabulary_size:\n"
    ".quad shoal_orb_vocabulary_end - shoal_orb_vocabulary\n"
    ".global shoal_orb_vocabulary\n"
    ".global shoal_orb_vocabulary_size\n"
    ".popsection\n");

extern "C" {
extern const uint8_t shoal_orb_vocabulary[];
extern const uint64_t shoal_orb_vocabulary_size;
}

namespace shoal::vision {

std::span<const uint8_t> shippedOrbVocabulary() {
  return {shoal_orb_vocabulary, static_cast<size_t>(shoal_orb_vocabulary_size)};
}

}  // namespace shoal::vision
