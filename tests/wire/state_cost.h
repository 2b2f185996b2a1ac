// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <vector>

#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/piece.h"
#include "shoal/wire/bytes.h"

namespace shoal::wire {

/// What some messages take.
struct Cost {
  size_t payload = 0;    ///< bytes of payloads
  size_t datagrams = 0;  ///< bytes with fixed fields, channel and LCM's header
  size_t count = 0;      ///< messages
};

/// Pieces of one robot and kind, ascending by key and part, in full datagrams on a channel like
/// SHOAL_R00_BRICK: as many a message as fit. Whole topics too large for one are cut first.
std::vector<Bytes> messagesOf(const std::vector<mapping::Piece>& pieces);
Cost costOf(const std::vector<mapping::Piece>& pieces);

/// All that a robot would tell somebody who knows nothing, but pictures.
struct StateCost {
  Cost topics, labels, certainties;
  size_t datagrams() const { return topics.datagrams + labels.datagrams + certainties.datagrams; }
};
StateCost costOfState(const mapping::LocalBelief& belief);

}  // namespace shoal::wire
