// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/newest_wins.h"

#include <algorithm>

namespace shoal::mapping {
namespace {

// One column after the other, each a comparison and a selection, so that the compiler takes them in vectors.
[[gnu::always_inline]] inline void take(const TileColumns& __restrict said, TileColumns& __restrict newest) {
  std::array<uint16_t, kTileCells> newer;  // all ones where it is, else 0
  for (size_t i = 0; i < kTileCells; ++i)
    newer[i] = said.time[i] >= newest.time[i] ? uint16_t{0xffff} : uint16_t{0};
  for (size_t i = 0; i < kTileCells; ++i) newest.time[i] = std::max(said.time[i], newest.time[i]);
  for (size_t i = 0; i < kTileCells; ++i)
    newest.voice[i] = static_cast<uint16_t>((said.voice[i] & newer[i]) | (newest.voice[i] & ~newer[i]));
  for (size_t i = 0; i < kTileCells; ++i) {
    const auto mask = static_cast<uint8_t>(newer[i]);
    newest.certainty[i] = static_cast<uint8_t>((said.certainty[i] & mask) | (newest.certainty[i] & ~mask));
  }
}

void takeAnywhere(const TileColumns& said, TileColumns& newest) { take(said, newest); }

#if defined(__x86_64__)
__attribute__((target("avx2"))) void takeAvx2(const TileColumns& said, TileColumns& newest) {
  take(said, newest);
}
#endif

using Take = void (*)(const TileColumns&, TileColumns&);

Take fastest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return &takeAvx2;
#endif
  return &takeAnywhere;
}

}  // namespace

void takeNewer(const TileColumns& said, TileColumns& newest) {
  static const Take chosen = fastest();
  chosen(said, newest);
}

}  // namespace shoal::mapping
