// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "shoal/mapping/piece.h"
#include "shoal/world/ids.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::mapping {

/// A topic with its exact counts, as its robot holds it.
struct BelievedTopic {
  world::TopicId id{};
  world::Timestamp created;
  int64_t weight = 0;                   ///< words assigned
  std::vector<world::WordCount> words;  ///< exact, ascending by word
  bool operator==(const BelievedTopic&) const = default;
};

/// A cell as its robot labels it.
struct BelievedCell {
  world::CellIndex cell;
  world::TopicId topic{};
  world::Timestamp seen;
  float certainty = 0;  ///< in [0, 1]
  float surprise = 0;   ///< how unusual it was when seen, >= 0; 1 is what one cell in ten exceeds
  bool operator==(const BelievedCell&) const = default;
};

/// A picture that shows what a topic looks like, as its robot keeps it.
struct ExamplePicture {
  static constexpr int kEdge = 32;  ///< pixels

  world::TopicId topic{};
  int32_t number = 0;        ///< in [0, kMaxExamples); 0 is the most typical
  int32_t observation = 0;   ///< at which it became the example, or ceased to be one
  world::CellIndex cell;     ///< in the middle
  world::Timestamp seen;     ///< mission time of the image it was cut from
  std::vector<uint8_t> rgb;  ///< kEdge rows of kEdge pixels of 3 bytes; empty: the example is no more
  bool operator==(const ExamplePicture&) const = default;
};

/// How finely a robot tells what it believes: bytes against detail. Labels and times are exact in both.
enum class Detail {
  kFine,   ///< topics in thousandths of their norm, certainties in ninths
  kCoarse  ///< as coarsely as keeps their cosine above .99, in thirds
};

/// "fine", "coarse", and back; nothing for another text.
std::string_view toText(Detail detail);
std::optional<Detail> parseDetail(std::string_view text);

/// All that one robot believes at one moment: its topics, its labelled cells, and pictures of its
/// topics.
struct LocalBelief {
  world::RobotId robot{};
  world::Version version;  ///< of the latest observation in it
  std::vector<world::WordGroup> groups;
  std::vector<BelievedTopic> topics;          ///< ascending by id
  std::vector<BelievedCell> cells;            ///< ascending by cell
  std::vector<ExamplePicture> examples = {};  ///< ascending by topic, then number
  Detail detail = Detail::kFine;              ///< of what it tells the others
};

/// A topic's counts as integers fit to travel: divided by a thousandth of their L2 norm, when that is above
/// 1, and rounded half up; words that round to 0 are left out. One step for all words, so that the word
/// groups keep their weights. Of n words in all the cosine to the exact counts stays above 1 - n / 8,000,000.
/// Coarse ones are rounded to multiples of the largest unit, in whole steps up to a tenth of the norm, that
/// keeps the cosine above .99; where none does, they are as fine ones. Cost: O(n), coarse up to 100 times
/// that.
std::vector<world::WordCount> quantize(const std::vector<world::WordCount>& counts,
                                       Detail detail = Detail::kFine);

/// A certainty in [0, 1] in steps of 1/63, fit to travel: rounded to ninths, to thirds when coarse. Finer
/// steps rank errors hardly better and take far more bytes: docs/labels.md.
uint8_t certaintySteps(float certainty, Detail detail = Detail::kFine);

/// A surprise in steps of 1/8, fit to travel: 0 below 1.5, so that only what stands out takes bytes, the last
/// step for all that is above it.
uint8_t surpriseSteps(float surprise);

}  // namespace shoal::mapping
