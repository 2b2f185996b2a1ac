// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "shoal/wire/bit_mixer.h"

namespace shoal::wire {

/// Many contexts, all new. A message touches few of them, and clearing all for each would cost more than
/// coding a brick does: so every thread keeps the memory of the tables it had, and a context that an earlier
/// message used becomes new when it is asked for.
class ContextTable {
 public:
  explicit ContextTable(size_t size) : memory_(take(size)), generation_(memory_.generation) {}
  ~ContextTable() { giveBack(std::move(memory_)); }
  ContextTable(const ContextTable&) = delete;
  ContextTable& operator=(const ContextTable&) = delete;

  ContextBit& operator[](size_t i) {
    ContextBit& context = memory_.contexts[i];
    if (context.generation != generation_) {
      context = {};
      context.generation = generation_;
    }
    return context;
  }

 private:
  struct Memory {
    std::vector<ContextBit> contexts;
    uint8_t generation = 1;  // of no context at first
  };
  static Memory take(size_t size);
  static void giveBack(Memory memory);
  static std::vector<Memory>& kept();

  Memory memory_;
  uint8_t generation_;
};

}  // namespace shoal::wire
