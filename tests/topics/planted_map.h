// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "shoal/random.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// A square of cells whose classes are a sample of a Potts field, each class with multinomials of its own
/// over two kinds of words: what CellLabelModel takes the world for.
class PlantedMap {
 public:
  static constexpr int32_t kSide = 24;
  static constexpr int32_t kWordsInCell = 30;  // of each kind, in every image

  PlantedMap(uint64_t seed, int32_t num_classes) : random_(seed), num_classes_(num_classes) {
    for (int32_t& c : class_) c = static_cast<int32_t>(random_.below(static_cast<uint64_t>(num_classes)));
    for (int sweep = 0; sweep < 30; ++sweep) {
      for (int32_t cell = 0; cell < kSide * kSide; ++cell)
        class_[static_cast<size_t>(cell)] = drawClass(cell);
    }
  }

  static std::vector<world::WordGroup> groups() {
    return {{.name = "color", .first = 0, .size = 40}, {.name = "shape", .first = 40, .size = 60}};
  }

  int32_t classOf(const world::CellIndex& cell) const {
    return class_[static_cast<size_t>(cell.x * kSide + cell.y)];
  }

  /// Image n shows columns n and n + 1, for n up to kSide - 2.
  world::WordsInCells image(int32_t n) {
    world::WordsInCells image{.observation = n, .time = world::Timestamp{n * 1'000'000LL}, .cells = {}};
    for (int32_t x = n; x < n + 2; ++x) {
      for (int32_t y = 0; y < kSide; ++y) {
        std::map<int32_t, int32_t> counts;
        for (const world::WordGroup& group : groups()) {
          for (int i = 0; i < kWordsInCell; ++i) ++counts[group.first + word(classOf({x, y, 0}), group.size)];
        }
        world::CellWords& cell = image.cells.emplace_back(world::CellWords{{x, y, 0}, {}});
        for (const auto& [word, count] : counts) cell.words.push_back({word, count});
      }
    }
    return image;
  }

 private:
  // One word in four comes from anywhere, the others from a window of the vocabulary that half overlaps with
  // the next class's.
  int32_t word(int32_t c, int32_t size) {
    if (random_.uniform() < 0.25) return static_cast<int32_t>(random_.below(static_cast<uint64_t>(size)));
    const int32_t width = 2 * size / num_classes_;
    return (c * size / num_classes_ + static_cast<int32_t>(random_.below(static_cast<uint64_t>(width)))) %
           size;
  }

  // exp(J) = 3 for every alike neighbour.
  int32_t drawClass(int32_t cell) {
    std::vector<double> weight(static_cast<size_t>(num_classes_), 1.0);
    const int32_t x = cell / kSide, y = cell % kSide;
    for (const auto& [dx, dy] : {std::pair{-1, 0}, {1, 0}, {0, -1}, {0, 1}}) {
      if (x + dx < 0 || x + dx >= kSide || y + dy < 0 || y + dy >= kSide) continue;
      weight[static_cast<size_t>(class_[static_cast<size_t>((x + dx) * kSide + y + dy)])] *= 3.0;
    }
    double sum = 0;
    for (const double w : weight) sum += w;
    double point = random_.uniform() * sum;
    for (int32_t c = 0; c + 1 < num_classes_; ++c) {
      point -= weight[static_cast<size_t>(c)];
      if (point < 0) return c;
    }
    return num_classes_ - 1;
  }

  Random random_;
  int32_t num_classes_;
  std::vector<int32_t> class_ = std::vector<int32_t>(kSide * kSide);
};

}  // namespace shoal::topics
