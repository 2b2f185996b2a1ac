// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "shoal/mapping/piece.h"

namespace shoal::eval {

/// What a piece takes on the wire, each of its datagrams with all headers.
struct PieceCost {
  int64_t bytes = 0;
  int64_t datagrams = 0;
  PieceCost& operator+=(const PieceCost& other);
};

/// A piece by itself: not joined with others in a datagram, as robots join topics and bricks.
PieceCost costOf(const mapping::Piece& whole);

}  // namespace shoal::eval
