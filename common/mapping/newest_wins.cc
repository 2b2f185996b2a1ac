// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/newest_wins.h"

#include <bit>
#include <cstring>

namespace shoal::mapping {
namespace {

// Cells that are compared at once. (Compilers make of these what a machine has.)
struct Row1 {  // those of a row, ranks of one byte
  using Rank = uint8_t;
  using Ranks = uint8_t __attribute__((vector_size(16)));
  using Bytes = uint8_t __attribute__((vector_size(16)));
};
struct Rows1 {  // of two rows
  using Ranks = uint8_t __attribute__((vector_size(32)));
  using Bytes = uint8_t __attribute__((vector_size(32)));
};
struct Row2 {
  using Rank = uint16_t;
  using Ranks = uint16_t __attribute__((vector_size(32)));
  using Bytes = uint8_t __attribute__((vector_size(16)));
};
struct Row4 {
  using Rank = uint32_t;
  using Ranks = uint32_t __attribute__((vector_size(64)));
  using Bytes = uint8_t __attribute__((vector_size(16)));
};

template <class Cells>
[[gnu::always_inline]] inline void takeCells(const std::byte* said, const std::byte* said_certainty,
                                             std::byte* newest, std::byte* certainty) {
  typename Cells::Ranks a, b;
  typename Cells::Bytes c, d;
  std::memcpy(&a, said, sizeof a);
  std::memcpy(&b, newest, sizeof b);
  std::memcpy(&c, said_certainty, sizeof c);
  std::memcpy(&d, certainty, sizeof d);
  const auto is_newer = reinterpret_cast<typename Cells::Ranks>(a > b);  // all ones where it is, else 0
  const auto bytes = __builtin_convertvector(is_newer, typename Cells::Bytes);
  b = (a & is_newer) | (b & ~is_newer);
  d = (c & bytes) | (d & ~bytes);
  std::memcpy(newest, &b, sizeof b);
  std::memcpy(certainty, &d, sizeof d);
}

// AtOnce: where there are all rows.
template <class Row, class AtOnce>
[[gnu::always_inline]] inline void take(const std::byte* said, unsigned rows, std::byte* newest,
                                        bool is_first) {
  constexpr size_t kRank = sizeof(typename Row::Rank), kRow = kTileEdge * kRank;
  std::byte* const certainty = newest + kTilePlaces * kRank;
  if (rows == 0xFFFF && is_first) {
    std::memcpy(newest, said, kTilePlaces * (kRank + 1));
    return;
  }
  const std::byte* said_certainty = said + static_cast<size_t>(std::popcount(rows)) * kRow;
  if (rows == 0xFFFF) {
    for (size_t i = 0; i < kTilePlaces; i += sizeof(typename AtOnce::Bytes))
      takeCells<AtOnce>(said + i * kRank, said_certainty + i, newest + i * kRank, certainty + i);
    return;
  }
  if (is_first) std::memset(newest, 0, kTilePlaces * (kRank + 1));
  for (; rows != 0; rows &= rows - 1, said += kRow, said_certainty += kTileEdge) {
    const auto row = static_cast<size_t>(std::countr_zero(rows));
    takeCells<Row>(said, said_certainty, newest + row * kRow, certainty + row * kTileEdge);
  }
}

[[gnu::always_inline]] inline void takeRanks(const std::byte* said, unsigned rows, size_t rank,
                                             std::byte* newest, bool is_first) {
  if (rank == 1) return take<Row1, Rows1>(said, rows, newest, is_first);
  if (rank == 2) return take<Row2, Row2>(said, rows, newest, is_first);
  take<Row4, Row4>(said, rows, newest, is_first);
}

void takeAnywhere(const std::byte* said, uint16_t rows, size_t rank, std::byte* newest, bool is_first) {
  takeRanks(said, rows, rank, newest, is_first);
}

#if defined(__x86_64__)
__attribute__((target("avx2"))) void takeAvx2(const std::byte* said, uint16_t rows, size_t rank,
                                              std::byte* newest, bool is_first) {
  takeRanks(said, rows, rank, newest, is_first);
}
#endif

using Take = void (*)(const std::byte*, uint16_t, size_t, std::byte*, bool);

Take fastest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return &takeAvx2;
#endif
  return &takeAnywhere;
}

}  // namespace

void takeNewer(const std::byte* said, uint16_t rows, size_t rank, std::byte* newest, bool is_first) {
  static const Take chosen = fastest();
  chosen(said, rows, rank, newest, is_first);
}

}  // namespace shoal::mapping
