// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "shoal/mapping/local_belief.h"
#include "shoal/robot/typicality.h"
#include "shoal/world/grid.h"
#include "shoal/world/observation.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::robot {

/// Keeps a few pictures of cells that show what each of a robot's topics looks like: medoids among the cells
/// that it has seen whole, by Typicality and certainty.
///
/// Topics drift, and pictures are dear to send, so an example stays unless something is clearly better: an
/// eighth more typical (an example whose cell has another topic by now counts half), and not before 4 images,
/// then 8, 16, ... after its last change: in n images an example changes at most log2(n / 4) + 1 times.
/// Memory: at most 4 pictures of 3 kB a topic. Deterministic: ties go to the lower cell.
class ExampleBook {
 public:
  static constexpr int kExamples = 2;  ///< of a topic

  explicit ExampleBook(double cell_size_m) : grid_(cell_size_m) {}

  /// Looks at one image for better examples.
  /// @param words   what was found in the image, by cell.
  /// @param belief  what the robot believes after it has learnt from these words.
  void look(const world::Observation& observation, const world::WordsInCells& words,
            const mapping::LocalBelief& belief);

  /// The same, of a belief whose cells are asked for one by one: what is believed of a cell, nothing when it
  /// is unknown. A look asks for those of the image, and four a topic. @param outline  the belief; its cells
  /// are not looked at.
  using CellBelief = std::function<std::optional<mapping::BelievedCell>(const world::CellIndex&)>;
  void look(const world::Observation& observation, const world::WordsInCells& words,
            const mapping::LocalBelief& outline, const CellBelief& believed);

  /// Ascending by topic, then number; those of topics that are gone have no pixels.
  std::vector<mapping::ExamplePicture> examples() const;

  /// The whole book as bytes, and back. @param vocabulary  words of the robot.
  /// @throws std::runtime_error for what checkpoint() does not give.
  std::vector<uint8_t> checkpoint() const;
  void restore(std::span<const uint8_t> checkpoint, int32_t vocabulary);

 private:
  struct Picture {
    world::CellIndex cell;
    world::Timestamp seen;
    std::vector<world::WordCount> words;
    std::vector<uint8_t> rgb;
    int32_t score = 0;  // of the last look
  };
  struct Slot {
    Picture picture;
    int32_t observation = 0;  // of its last change
    int32_t changes = 0;      // 0: never filled
  };
  struct Page {
    std::vector<Slot> slots = std::vector<Slot>(kExamples);
    std::vector<Picture> spares;  // best first
  };
  struct Look {
    const world::Observation& observation;
    const mapping::LocalBelief& belief;  // but for its cells
    const CellBelief& believed;
    Typicality typicality;
  };
  int32_t score(const Look& look, const std::vector<world::WordCount>& words, const world::CellIndex& cell,
                world::TopicId topic) const;
  void rescore(const Look& look, world::TopicId topic, Page& page) const;
  void collect(const Look& look, const world::WordsInCells& words);
  void choose(int32_t observation, Page& page) const;

  world::Grid grid_;
  std::map<world::TopicId, Page> pages_;
};

}  // namespace shoal::robot
