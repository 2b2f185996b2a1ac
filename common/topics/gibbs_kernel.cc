// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/gibbs_kernel.h"

#include <algorithm>
#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shoal/topics/gibbs_kernel.cc"
// Those left out have nothing more to offer here; vectors whose length is not known have no arrays.
#define HWY_DISABLED_TARGETS (HWY_SSSE3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace shoal::topics {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
using Ints = hn::RebindToSigned<Floats>;
using Words = hn::RebindToUnsigned<Floats>;
using VF = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;
using VW = hn::Vec<Words>;
constexpr Floats kF;
constexpr Ints kI;
constexpr Words kW;

// The lanes are one register of sixteen, two of eight, four of four or sixteen scalars: parts, drawn apart.
constexpr int32_t kWidth = static_cast<int32_t>(hn::MaxLanes(Floats()));

// What a round reads and writes beside the lanes, [lane].
struct Round {
  alignas(64) int32_t drawn[kLanes];    // slot of the token's new topic
  alignas(64) int32_t own[kLanes];      // slot of its topic so far; -1: it has none
  alignas(64) int32_t running[kLanes];  // -1: the lane has a token to draw, 0: it has none, or opens a topic
  int32_t* row[kLanes];                 // n_kw of the token's word, or of any
  int32_t order[kLanes];                // lanes that run
};

// 32 random bits: the finaliser of a good multiplicative hash (T. Wang's form, constants by C. Wellons'
// prospector), of the lane's counter, with its key in the middle.
HWY_INLINE VW scattered(VW counter, VW key) {
  VW x = hn::Xor(counter, hn::ShiftRight<16>(counter));
  x = hn::Xor(hn::Mul(x, hn::Set(kW, 0x21f0aaadu)), key);
  x = hn::Xor(x, hn::ShiftRight<15>(x));
  x = hn::Mul(x, hn::Set(kW, 0x735a2d97u));
  return hn::Xor(x, hn::ShiftRight<15>(x));
}

HWY_INLINE VF asFloats(VW below_two_to_31) { return hn::ConvertTo(kF, hn::BitCast(kI, below_two_to_31)); }

// a + 1 where the mask is set.
HWY_INLINE VI more(VI a, hn::Mask<Ints> mask) {
#if HWY_TARGET == HWY_AVX3
  return hn::IfThenElse(mask, hn::Add(a, hn::Set(kI, 1)), a);
#else
  return hn::Sub(a, hn::VecFromMask(kI, mask));
#endif
}

// a - 1 where the mask is set.
HWY_INLINE VI less(VI a, hn::Mask<Ints> mask) {
#if HWY_TARGET == HWY_AVX3
  return hn::IfThenElse(mask, hn::Sub(a, hn::Set(kI, 1)), a);
#else
  return hn::Add(a, hn::VecFromMask(kI, mask));
#endif
}
HWY_INLINE VF less(VF a, hn::Mask<Ints> mask) {
  const auto same = hn::RebindMask(kF, mask);
#if HWY_TARGET == HWY_AVX3
  return hn::IfThenElse(same, hn::Sub(a, hn::Set(kF, 1.0F)), a);
#else
  return hn::Sub(a, hn::IfThenElseZero(same, hn::Set(kF, 1.0F)));
#endif
}

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE void loadSlots(int32_t* const* rows, int32_t k, VI* out) {
  for (int32_t i = 0; i < kSlotsTogether; ++i) out[i] = hn::Set(kI, rows[0][k + i]);
}

#else

// Blocks of four rows, one beside the other: rows i, 4 + i, 8 + i and 12 + i.
HWY_INLINE VI loadBlocks(int32_t* const* rows, int32_t k) {
#if HWY_TARGET == HWY_AVX3
  VI v = hn::LoadDup128(kI, rows[0] + k);
  v = hn::IfThenElse(hn::Mask<Ints>{0x00F0}, hn::LoadDup128(kI, rows[4] + k), v);
  v = hn::IfThenElse(hn::Mask<Ints>{0x0F00}, hn::LoadDup128(kI, rows[8] + k), v);
  v = hn::IfThenElse(hn::Mask<Ints>{0xF000}, hn::LoadDup128(kI, rows[12] + k), v);
  return v;
#elif HWY_TARGET == HWY_AVX2
  const hn::Half<Ints> half;
  return hn::Combine(kI, hn::LoadU(half, rows[4] + k), hn::LoadU(half, rows[0] + k));
#else
  return hn::LoadDup128(kI, rows[0] + k);
#endif
}

// Slots k to k + 3 of each row: out[i] has slot k + i of all.
HWY_INLINE void loadSlots(int32_t* const* rows, int32_t k, VI* out) {
  const hn::Repartition<uint64_t, Ints> pairs;
  VI row[4];
  for (int32_t i = 0; i < 4; ++i) row[i] = loadBlocks(rows + i, k);
  const auto low01 = hn::BitCast(pairs, hn::InterleaveLower(kI, row[0], row[1]));
  const auto high01 = hn::BitCast(pairs, hn::InterleaveUpper(kI, row[0], row[1]));
  const auto low23 = hn::BitCast(pairs, hn::InterleaveLower(kI, row[2], row[3]));
  const auto high23 = hn::BitCast(pairs, hn::InterleaveUpper(kI, row[2], row[3]));
  out[0] = hn::BitCast(kI, hn::InterleaveLower(pairs, low01, low23));
  out[1] = hn::BitCast(kI, hn::InterleaveUpper(pairs, low01, low23));
  out[2] = hn::BitCast(kI, hn::InterleaveLower(pairs, high01, high23));
  out[3] = hn::BitCast(kI, hn::InterleaveUpper(pairs, high01, high23));
}

#endif

// One part's draws of a round. Where a topic opens, running becomes 0. True: somewhere.
template <bool kMayOpen>
HWY_INLINE bool drawPart(const Table& table, const float* HWY_RESTRICT inverse, Lanes& lanes, Round& round,
                         int32_t first) {
  const VF beta = hn::Set(kF, table.beta);
  const float* HWY_RESTRICT const counts = lanes.counts.data() + first;
  const float* HWY_RESTRICT const prior = lanes.prior.data() + first;
  float* HWY_RESTRICT const sums = lanes.sums.data() + first;
  const int32_t num_slots = table.num_slots;
  VI own = hn::Load(kI, round.own + first);
  VF total = hn::Zero(kF);
  for (int32_t k = 0; k < num_slots; k += kSlotsTogether) {
    VI of_word[kSlotsTogether];
    loadSlots(round.row + first, k, of_word);
    VF within = hn::Zero(kF);
    for (int32_t i = 0; i < kSlotsTogether; ++i) {
      const int32_t at = (k + i) * kLanes;
      const auto is_own = hn::Eq(own, hn::Set(kI, i));
      const VF others = hn::ConvertTo(kF, less(of_word[i], is_own));
      const VF word_weight = hn::Mul(hn::Add(others, beta), hn::Set(kF, inverse[k + i]));
      const VF in_cell = less(hn::Load(kF, counts + at), is_own);
      const VF weight = hn::Mul(word_weight, hn::Add(in_cell, hn::Load(kF, prior + at)));
      within = i == 0 ? weight : hn::Add(within, weight);
      hn::Store(hn::Add(total, within), kF, sums + at);
    }
    total = hn::Add(total, within);
    own = hn::Sub(own, hn::Set(kI, kSlotsTogether));
  }

  VI running = hn::Load(kI, round.running + first);
  const VW step = hn::And(hn::BitCast(kW, running), hn::Set(kW, 0x9e3779b9u));
  const VW counter = hn::Add(hn::Load(kW, lanes.counter.data() + first), step);
  hn::Store(counter, kW, lanes.counter.data() + first);
  const VW key = hn::Load(kW, lanes.key.data() + first);
  // The midpoint of one of 2^23 equal parts of (0, 1); exact.
  const VF uniform = hn::Mul(hn::Add(asFloats(hn::ShiftRight<9>(scattered(counter, key))), hn::Set(kF, 0.5F)),
                             hn::Set(kF, 0x1p-23F));
  const VF point = hn::Mul(total, uniform);
  bool opens = false;
  if constexpr (kMayOpen) {
    // In (0, 1] as fine as float is, from 48 bits: the probability may be 1e-12.
    const VW coarse = scattered(counter, hn::Xor(key, hn::Set(kW, 0x5bd1e995u)));
    const VW fine = scattered(counter, hn::Xor(key, hn::Set(kW, 0xa6c9ff3du)));
    const VF small = hn::Add(
        hn::Mul(asFloats(hn::ShiftRight<8>(coarse)), hn::Set(kF, 0x1p-24F)),
        hn::Mul(hn::Add(asFloats(hn::ShiftRight<8>(fine)), hn::Set(kF, 0.5F)), hn::Set(kF, 0x1p-48F)));
    const VF mass = hn::Set(kF, table.opening_mass);
    const VI opening =
        hn::BitCast(kI, hn::VecFromMask(kF, hn::Le(hn::Mul(small, hn::Add(total, mass)), mass)));
    const VI opening_here = hn::And(opening, running);
    opens = !hn::AllTrue(kI, hn::Eq(opening_here, hn::Zero(kI)));
    running = hn::AndNot(opening, running);
    hn::Store(running, kI, round.running + first);
  }
  VI drawn = hn::Zero(kI);
  for (int32_t k = 0; k < num_slots; k += kSlotsTogether) {
    for (int32_t i = 0; i < kSlotsTogether; ++i) {
      const int32_t at = (k + i) * kLanes;
      drawn = more(drawn, hn::RebindMask(kI, hn::Le(hn::Load(kF, sums + at), point)));
    }
  }
  hn::Store(drawn, kI, round.drawn + first);
  return opens;
}

HWY_INLINE float& countOf(Lanes& lanes, int32_t slot, uint32_t lane) {
  return lanes.counts[static_cast<size_t>(slot * kLanes) + lane];
}

// The row of a token's word, and the memory it is in fetched.
HWY_INLINE int32_t* fetchedRow(const Table& table, const Token& token) {
  int32_t* const row = table.word_counts + int64_t{token.word} * table.stride;
  hwy::Prefetch(row);
  hwy::Prefetch(row + std::min(table.stride - 1, 16));
  return row;
}

// The next tokens. @returns how many of the lanes named have one: they run.
int32_t fetchTokens(const Table& table, const Lanes& lanes, const int32_t* named, int32_t num_named,
                    Round& round) {
  int32_t num_running = 0;
  for (int32_t i = 0; i < num_named; ++i) {
    const auto j = static_cast<uint32_t>(named[i]);
    const bool runs = lanes.next[j] != lanes.end[j];
    round.running[j] = runs ? -1 : 0;
    round.own[j] = -1;
    if (!runs) continue;
    round.order[num_running++] = named[i];
    round.row[j] = fetchedRow(table, *lanes.next[j]);
    round.own[j] = lanes.next[j]->slot;
  }
  return num_running;
}

// Moves a lane's word from its topic to the one drawn; most stay.
HWY_INLINE void giveTopic(Lanes& lanes, const Round& round, uint32_t lane, Token& token) {
  const int32_t drawn = round.drawn[lane], own = round.own[lane];
  if (drawn == own) return;
  token.slot = drawn;
  ++round.row[lane][drawn];
  countOf(lanes, drawn, lane) += 1.0F;
  if (own < 0) return;
  --round.row[lane][own];
  countOf(lanes, own, lane) -= 1.0F;
}

// Gives the round's first tokens, so many, the topics drawn.
void giveTopics(Lanes& lanes, const Round& round, int32_t num_tokens) {
  for (int32_t i = 0; i < num_tokens; ++i) {
    const auto j = static_cast<uint32_t>(round.order[i]);
    giveTopic(lanes, round, j, *lanes.next[j]++);
  }
}

// giveTopics() and fetchTokens() where every lane has three tokens at least; fetches the rows of the third.
HWY_INLINE void goOn(const Table& table, Lanes& lanes, Round& round, int32_t num_running) {
  const int64_t stride = table.stride;
  int32_t* const HWY_RESTRICT word_counts = table.word_counts;
  const int64_t second_line = std::min<int64_t>(stride - 1, 16);
  for (int32_t i = 0; i < num_running; ++i) {
    const auto j = static_cast<uint32_t>(round.order[i]);
    Token* const token = lanes.next[j];
    giveTopic(lanes, round, j, token[0]);
    round.row[j] = word_counts + token[1].word * stride;
    round.own[j] = token[1].slot;
    lanes.next[j] = token + 1;
    const int32_t* const later = word_counts + token[2].word * stride;
    hwy::Prefetch(later);
    hwy::Prefetch(later + second_line);
  }
}

// For how many rounds goOn() may be called.
int32_t roundsAlike(const Lanes& lanes, const Round& round, int32_t num_running) {
  int64_t rounds = std::numeric_limits<int32_t>::max();
  for (int32_t i = 0; i < num_running; ++i) {
    const auto j = static_cast<size_t>(round.order[i]);
    rounds = std::min<int64_t>(rounds, lanes.end[j] - lanes.next[j] - 2);
  }
  return static_cast<int32_t>(rounds);
}

template <bool kMayOpen>
Drawn drawRoundsOf(const Table& table, const float* inverse, Lanes& lanes, const int32_t* running,
                   int32_t num_running, int32_t max_rounds, int32_t max_finished) {
  Round round;
  std::fill_n(round.row, kLanes, table.word_counts);
  std::fill_n(round.running, kLanes, 0);
  std::fill_n(round.own, kLanes, -1);
  const int32_t enough = std::max(num_running - max_finished, 0);
  Drawn result;
  num_running = fetchTokens(table, lanes, running, num_running, round);
  int32_t alike = roundsAlike(lanes, round, num_running);
  for (int32_t r = 0; r < max_rounds && num_running > enough; ++r) {
    bool opens = false;
    for (int32_t first = 0; first < kLanes; first += kWidth) {
      opens |= drawPart<kMayOpen>(table, inverse, lanes, round, first);
    }
    if (opens) {
      int32_t num_before = 0;
      while (round.running[round.order[num_before]] != 0) ++num_before;
      giveTopics(lanes, round, num_before);
      result.num_drawn += num_before;
      result.opening = round.order[num_before];
      return result;
    }
    result.num_drawn += num_running;
    if (alike-- > 0) {
      goOn(table, lanes, round, num_running);
    } else {
      giveTopics(lanes, round, num_running);
      num_running = fetchTokens(table, lanes, round.order, num_running, round);
      alike = roundsAlike(lanes, round, num_running);
    }
  }
  return result;
}

Drawn drawRoundsHere(const Table& table, const float* inverse, Lanes& lanes, const int32_t* running,
                     int32_t num_running, int32_t max_rounds, int32_t max_finished) {
  const auto draw = table.opening_mass > 0.0F ? drawRoundsOf<true> : drawRoundsOf<false>;
  return draw(table, inverse, lanes, running, num_running, max_rounds, max_finished);
}

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE void sumsOfFour(const VI* slots, int32_t* sums) {
  for (int32_t i = 0; i < kSlotsTogether; ++i) sums[i] += hn::GetLane(slots[i]);
}

#else

// sums[i] += the sum of slots[i].
HWY_INLINE void sumsOfFour(const VI* slots, int32_t* sums) {
  const hn::Repartition<uint64_t, Ints> pairs;
  const VI two01 =
      hn::Add(hn::InterleaveLower(kI, slots[0], slots[1]), hn::InterleaveUpper(kI, slots[0], slots[1]));
  const VI two23 =
      hn::Add(hn::InterleaveLower(kI, slots[2], slots[3]), hn::InterleaveUpper(kI, slots[2], slots[3]));
  const auto a = hn::BitCast(pairs, two01), b = hn::BitCast(pairs, two23);
  const VI blocks = hn::Add(hn::BitCast(kI, hn::InterleaveLower(pairs, a, b)),
                            hn::BitCast(kI, hn::InterleaveUpper(pairs, a, b)));
  const hn::FixedTag<int32_t, 4> four;
#if HWY_TARGET == HWY_AVX3
  const hn::Half<Ints> half;
  const auto folded = hn::Add(hn::LowerHalf(half, blocks), hn::UpperHalf(half, blocks));
  const auto sum = hn::Add(hn::LowerHalf(four, folded), hn::UpperHalf(four, folded));
#elif HWY_TARGET == HWY_AVX2
  const auto sum = hn::Add(hn::LowerHalf(four, blocks), hn::UpperHalf(four, blocks));
#else
  const auto sum = blocks;
#endif
  hn::Store(hn::Add(hn::Load(four, sums), sum), four, sums);
}

#endif

Totals refreshHere(const Table& table, const Lanes& lanes, const int32_t* named, int32_t num_named,
                   int32_t* topic_counts, float* inverse) {
  alignas(64) int32_t mask[kLanes] = {};
  for (int32_t i = 0; i < num_named; ++i) mask[named[i]] = -1;
  Totals totals;
  for (int32_t k = 0; k < table.stride; k += kSlotsTogether) {
    alignas(16) int32_t count[kSlotsTogether];
    for (int32_t i = 0; i < kSlotsTogether; ++i) count[i] = table.outside[k + i];
    for (int32_t first = 0; first < kLanes; first += kWidth) {
      VI slots[kSlotsTogether];
      for (int32_t i = 0; i < kSlotsTogether; ++i) {
        slots[i] = hn::And(hn::Load(kI, mask + first),
                           hn::ConvertTo(kI, hn::Load(kF, lanes.counts.data() + (k + i) * kLanes + first)));
      }
      sumsOfFour(slots, count);
    }
    for (int32_t i = 0; i < kSlotsTogether; ++i) {
      topic_counts[k + i] = count[i];
      inverse[k + i] = 1.0F / (static_cast<float>(count[i]) + table.beta_sum) * table.eligible[k + i];
      totals.max_inverse = std::max(totals.max_inverse, inverse[k + i]);
      totals.num_words += count[i];
      totals.stale |= (count[i] > 0) != (table.open[k + i] != 0);
    }
  }
  return totals;
}

}  // namespace HWY_NAMESPACE
}  // namespace shoal::topics
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shoal::topics {

HWY_EXPORT(drawRoundsHere);
HWY_EXPORT(refreshHere);

Lanes::Lanes(int32_t num_slots)
    : counts(static_cast<size_t>(num_slots * kLanes)),
      prior(static_cast<size_t>(num_slots * kLanes)),
      sums(static_cast<size_t>(num_slots * kLanes)) {}

Totals refresh(const Table& table, const Lanes& lanes, const int32_t* named, int32_t num_named,
               int32_t* topic_counts, float* inverse) {
  return HWY_DYNAMIC_DISPATCH(refreshHere)(table, lanes, named, num_named, topic_counts, inverse);
}

Drawn drawRounds(const Table& table, const float* inverse, Lanes& lanes, const int32_t* running,
                 int32_t num_running, int32_t max_rounds, int32_t max_finished) {
  return HWY_DYNAMIC_DISPATCH(drawRoundsHere)(table, inverse, lanes, running, num_running, max_rounds,
                                              max_finished);
}

std::vector<int64_t> gibbsTargets() {
  hwy::SetSupportedTargetsForTest(0);
  std::vector<int64_t> targets;
  for (int64_t rest = hwy::SupportedTargets() & HWY_TARGETS; rest != 0; rest &= rest - 1) {
    targets.push_back(rest & -rest);
  }
  return targets;
}

void useGibbsTarget(int64_t target) {
  hwy::SetSupportedTargetsForTest(target);
  hwy::GetChosenTarget().Update(hwy::SupportedTargets());
}

}  // namespace shoal::topics
#endif  // HWY_ONCE
