// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "shoal/mapping/global_map.h"
#include "shoal/mapping/piece.h"
#include "shoal/random.h"
#include "shoal/wire/bytes.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/message_kind.h"

namespace shoal::wire {

/// One message of each type with fixed content, as in tests/data/wire/. Never change one: add.
struct Example {
  std::string name;  ///< of the golden file, without ".bin"
  MessageKind kind{};
  Bytes bytes;
};
std::vector<Example> goldenExamples();

/// Decodes as `kind` and encodes what came out again; empty when refused. The error goes to *error.
Bytes decodeAndEncode(MessageKind kind, std::span<const uint8_t> bytes, DecodeError* error = nullptr);

/// A 16 x 16 patch of ground one cell thick, sloping by `slope` cells of height per cell, labelled in
/// `num_labels` blobs, last seen in strips at `num_times` distinct times, one a second.
mapping::Piece planarBrick(int num_labels, int num_times, double slope, uint64_t seed);

/// Any cells of the brick, each with probability `density`; labels and times without any order.
mapping::Piece noiseBrick(const std::array<int32_t, 3>& brick, double density, Random& random);
mapping::Piece noiseCertainty(const std::array<int32_t, 3>& brick, double density, Random& random);

/// `num_words` words of a vocabulary in `num_groups` groups, counts falling off as 1 / rank.
mapping::Piece topicPiece(int num_words, int vocabulary, int num_groups, int max_count, Random& random);

/// The largest, smallest and oddest values everywhere.
Heartbeat noiseHeartbeat(int num_robots, int robot_gap, Random& random);

}  // namespace shoal::wire
