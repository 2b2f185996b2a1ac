// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For this room's .cc files: which part of a piece it is.

#include <cstdint>

#include "shoal/mapping/piece.h"
#include "shoal/wire/range_coder.h"

namespace shoal::wire {

/// Codes num_parts and part of one piece after the other, in topics' payloads as in bricks': an adaptive bit,
/// for most are whole, and 8 bits of either where it is 1.
class PartCoder {
 public:
  /// @returns false for a part of fewer than two; piece_codec checks the rest.
  template <typename Coder>
  bool code(Coder& coder, mapping::Piece& piece) {
    if (coder.bit(is_part_, piece.num_parts > 1 ? 1 : 0) == 0) {
      piece.num_parts = 1;
      piece.part = 0;
      return true;
    }
    piece.num_parts = static_cast<int32_t>(coder.direct(static_cast<uint64_t>(piece.num_parts), 8));
    piece.part = static_cast<int32_t>(coder.direct(static_cast<uint64_t>(piece.part), 8));
    return piece.num_parts >= 2;
  }

 private:
  AdaptiveBit is_part_{64000, 10};
};

}  // namespace shoal::wire
