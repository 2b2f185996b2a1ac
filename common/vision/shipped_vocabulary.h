// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>

namespace shoal::vision {

/// The bytes of vocabularies/orb_5000.voc (profile "paper") and vocabularies/dense.voc (profile "best"),
/// built into this library: no path is needed at run time.
std::span<const uint8_t> shippedOrbVocabulary();
std::span<const uint8_t> shippedDenseVocabulary();

}  // namespace shoal::vision
