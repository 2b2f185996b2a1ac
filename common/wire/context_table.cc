// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/context_table.h"

#include <algorithm>
#include <utility>

namespace shoal::wire {
namespace {

constexpr size_t kMostKept = 16;  // tables of a thread: those of one message, and some

}  // namespace

std::vector<ContextTable::Memory>& ContextTable::kept() {
  thread_local std::vector<Memory> kept;
  return kept;
}

ContextTable::Memory ContextTable::take(size_t size) {
  std::vector<Memory>& all = kept();
  const auto same =
      std::find_if(all.begin(), all.end(), [&](const Memory& m) { return m.contexts.size() == size; });
  if (same == all.end()) return {std::vector<ContextBit>(size)};
  Memory memory = std::move(*same);
  all.erase(same);
  if (++memory.generation == 0) {  // all numbers were used: clear it after all
    std::fill(memory.contexts.begin(), memory.contexts.end(), ContextBit{});
    memory.generation = 1;
  }
  return memory;
}

void ContextTable::giveBack(Memory memory) {
  if (kept().size() < kMostKept) kept().push_back(std::move(memory));
}

}  // namespace shoal::wire
