// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/newest_wins.h"

#include <bit>
#include <cstring>

namespace shoal::mapping {
namespace {

// A row is two vectors of sixteen 16-bit numbers and one of bytes. (Compilers make of these what a machine
// has.)
using Words = uint16_t __attribute__((vector_size(32)));
using Bytes = uint8_t __attribute__((vector_size(16)));
static_assert(sizeof(Words) == sizeof(TileRow::time) && sizeof(Bytes) == sizeof(TileRow::certainty));

template <class Vector>
[[gnu::always_inline]] inline void blend(const void* said, void* newest, const Vector& newer) {
  Vector a, b;
  std::memcpy(&a, said, sizeof a);
  std::memcpy(&b, newest, sizeof b);
  b = (a & newer) | (b & ~newer);
  std::memcpy(newest, &b, sizeof b);
}

[[gnu::always_inline]] inline uint16_t take(const TileRow* said, uint16_t rows, TileColumns& newest,
                                            uint16_t shown) {
  for (unsigned left = rows; left != 0; left &= left - 1, ++said) {
    const auto row = static_cast<size_t>(std::countr_zero(left));
    uint16_t* const time = newest.time.data() + row * kTileEdge;
    uint16_t* const voice = newest.voice.data() + row * kTileEdge;
    uint8_t* const certainty = newest.certainty.data() + row * kTileEdge;
    if ((shown >> row & 1) == 0) {
      std::memcpy(time, &said->time, sizeof said->time);
      std::memcpy(voice, &said->voice, sizeof said->voice);
      std::memcpy(certainty, &said->certainty, sizeof said->certainty);
      continue;
    }
    Words a, b;
    std::memcpy(&a, &said->time, sizeof a);
    std::memcpy(&b, time, sizeof b);
    const Words newer = reinterpret_cast<Words>(a >= b);  // all ones where it is, else 0
    blend(&said->time, time, newer);
    blend(&said->voice, voice, newer);
    blend(&said->certainty, certainty, __builtin_convertvector(newer, Bytes));
  }
  return static_cast<uint16_t>(shown | rows);
}

uint16_t takeAnywhere(const TileRow* said, uint16_t rows, TileColumns& newest, uint16_t shown) {
  return take(said, rows, newest, shown);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) uint16_t takeAvx2(const TileRow* said, uint16_t rows, TileColumns& newest,
                                                  uint16_t shown) {
  return take(said, rows, newest, shown);
}
#endif

using Take = uint16_t (*)(const TileRow*, uint16_t, TileColumns&, uint16_t);

Take fastest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return &takeAvx2;
#endif
  return &takeAnywhere;
}

}  // namespace

uint16_t takeNewer(const TileRow* said, uint16_t rows, TileColumns& newest, uint16_t shown) {
  static const Take chosen = fastest();
  return chosen(said, rows, newest, shown);
}

}  // namespace shoal::mapping
