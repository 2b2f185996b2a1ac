// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <compare>
#include <cstdint>
#include <variant>
#include <vector>

#include "shoal/mapping/edit.h"
#include "shoal/world/ids.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::mapping {

/// What kinds of state travel. The numbers are part of the wire format.
enum class PieceKind : uint8_t {
  kTopic = 1,
  kBrick = 2,
  kCertainty = 3,
  kEdit = 4,
  kPicture = 5,
  kSettings = 6
};

/// What all operators decided is one share of the state, beside those of the robots.
inline constexpr world::RobotId kOperators{10000};

/// Names one unit of replicated state: a robot's topic (index = {topic id, 0, 0}), or a brick of its label
/// map or of its certainty (index = brick coordinates); or an operator's edit: keyOf();
/// or an example picture of a topic (index = {topic id, number of the example, 0}); or what a robot learns
/// with (index = {0, 0, 0}).
struct PieceKey {
  world::RobotId robot{};
  PieceKind kind = PieceKind::kTopic;
  std::array<int32_t, 3> index{};
  auto operator<=>(const PieceKey&) const = default;
};

/// Cells travel in cubes of 16 x 16 x 16.
inline constexpr int32_t kBrickEdge = 16;

/// The brick that holds a cell: floor division by kBrickEdge.
constexpr std::array<int32_t, 3> brickOf(const world::CellIndex& c) { return {c.x >> 4, c.y >> 4, c.z >> 4}; }

/// Some words of a topic's descriptor. Parts are cut by rank of probability mass: part 0 holds the heaviest
/// words and is usable alone. Weights are quantised integers, see quantize().
struct TopicPart {
  world::Timestamp created;          ///< mission time at which the topic was opened
  int64_t weight = 0;                ///< words assigned to the whole topic; 0 = retired: no words
  std::vector<int32_t> group_sizes;  ///< sizes of the word groups, in id order; their sum is the vocabulary
  std::vector<world::WordCount> words;  ///< this part's words, ascending by word; counts quantised, > 0
  bool operator==(const TopicPart&) const = default;
};

/// A labelled cell as its robot last saw it.
struct BrickCell {
  world::CellIndex cell;   ///< absolute; inside the piece's brick
  world::TopicId topic{};  ///< the robot's own topic
  world::Timestamp seen;   ///< mission time of the last image that put words here
  auto operator<=>(const BrickCell&) const = default;
};

/// Some cells of a brick of the label map; any part is usable alone.
struct BrickPart {
  std::vector<BrickCell> cells;  ///< ascending by cell, each once, not empty
  bool operator==(const BrickPart&) const = default;
};

/// Certainties are sent in steps of 1/63.
inline constexpr int kCertaintySteps = 63;

/// Surprises are sent in steps of 1/8, from 1.5 on: see surpriseSteps().
inline constexpr int kSurpriseStepsPerUnit = 8;
inline constexpr int kLeastSurpriseSteps = 12;
inline constexpr int kMostSurpriseSteps = 63;

struct CertaintyCell {
  world::CellIndex cell;
  uint8_t steps = 0;     ///< certainty x kCertaintySteps, rounded, in [0, kCertaintySteps]
  uint8_t surprise = 0;  ///< in steps, 0 or in [kLeastSurpriseSteps, kMostSurpriseSteps]
  auto operator<=>(const CertaintyCell&) const = default;
};

/// How certain some cells of a brick are, and which of them surprised; any part is usable alone.
struct CertaintyPart {
  std::vector<CertaintyCell> cells;  ///< ascending by cell, each once, not empty
  bool operator==(const CertaintyPart&) const = default;
};

/// A topic has at most so many example pictures, numbered from 0: the most typical.
inline constexpr int32_t kMaxExamples = 8;

/// One layer of a picture of a cell that shows what a topic looks like. Part 0 is a small picture, usable
/// alone; later parts sharpen it. The layers are bytes of wire/picture_coder.h, opaque here: nobody decodes
/// them before somebody looks.
struct PicturePart {
  world::CellIndex cell;       ///< what it shows, in the middle
  world::Timestamp seen;       ///< mission time of the image
  std::vector<uint8_t> layer;  ///< empty: the example is no more (part 0 of 1)
  bool operator==(const PicturePart&) const = default;
};

/// What a robot learns with: only topics learnt with the same are comparable. Said once in every epoch, as
/// version (epoch, 0).
struct SettingsPart {
  uint64_t words = 0;            ///< fingerprint of the visual vocabulary
  uint64_t hyperparameters = 0;  ///< fingerprint of what else decides what it learns
  double cell_size_m = 1;        ///< edge of a map cell, finite, > 0
  bool operator==(const SettingsPart&) const = default;
};

/// One datagram's worth of replicated state. Same key, version and part: same content.
struct Piece {
  PieceKey key;
  world::Version version;
  int32_t part = 0;       ///< in [0, num_parts)
  int32_t num_parts = 1;  ///< in [1, 255]
  std::variant<TopicPart, BrickPart, CertaintyPart, Edit, PicturePart, SettingsPart> content;
  bool operator==(const Piece&) const = default;
};

/// A hash of everything in a piece. Equal pieces, equal hash, on every machine.
uint64_t contentHash(const Piece& piece);

/// An edit as a piece. Its index holds its counter and a hash of its content, so that no two are mixed up.
PieceKey keyOf(const Edit& edit);
Piece pieceOf(const Edit& edit);

/// A robot's settings as a piece.
Piece pieceOf(world::RobotId robot, int32_t epoch, const SettingsPart& settings);

}  // namespace shoal::mapping
