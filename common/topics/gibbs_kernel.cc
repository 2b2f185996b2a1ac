// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/gibbs_kernel.h"

#include <algorithm>
#include <array>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "shoal/topics/gibbs_kernel.cc"
// Eight lanes are all there is to fill.
#define HWY_DISABLED_TARGETS \
  (HWY_SSSE3 | HWY_AVX3 | HWY_AVX3_DL | HWY_SVE | HWY_SVE2 | HWY_SVE_256 | HWY_SVE2_128)
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace shoal::topics {
namespace HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;

using Floats = hn::CappedTag<float, kLanes>;
using Ints = hn::RebindToSigned<Floats>;
using VF = hn::Vec<Floats>;
using VI = hn::Vec<Ints>;
constexpr Floats kF;
constexpr Ints kI;

// A vector of kLanes is one register of eight, two of four or eight scalars.
constexpr int32_t kWidth = static_cast<int32_t>(hn::MaxLanes(Floats()));
constexpr int32_t kParts = kLanes / kWidth;
static_assert(kWidth == 8 || kWidth == 4 || kWidth == 1);

HWY_INLINE VI asInts(hn::Mask<Floats> mask) { return hn::BitCast(kI, hn::VecFromMask(kF, mask)); }
HWY_INLINE VI asInts(hn::Mask<Ints> mask) { return hn::VecFromMask(kI, mask); }
HWY_INLINE int32_t countTrue(VI mask) {
  return static_cast<int32_t>(hn::CountTrue(kI, hn::MaskFromVec(mask)));
}

// Prefix sums over eight lanes, by halves (Sklansky): within pairs, within fours, the lower four into the
// upper. Sums so built never descend from lane to lane, and a lane of weight 0 has the sum of the one before.
struct Prefix {
  VF inclusive[kParts];
  VF exclusive[kParts];
  VF total;  // in every lane
};

#if HWY_TARGET == HWY_SCALAR

HWY_INLINE Prefix prefix(const VF* values) {
  Prefix out;
  for (int32_t p = 0; p < kLanes; ++p) out.inclusive[p] = values[p];
  for (int32_t half = 1; half < kLanes; half *= 2) {
    for (int32_t p = 0; p < kLanes; ++p) {
      if (p & half) out.inclusive[p] = hn::Add(out.inclusive[p], out.inclusive[(p | (half - 1)) - half]);
    }
  }
  out.exclusive[0] = hn::Zero(kF);
  for (int32_t p = 1; p < kLanes; ++p) out.exclusive[p] = out.inclusive[p - 1];
  out.total = out.inclusive[kLanes - 1];
  return out;
}

#else

HWY_INLINE Prefix prefix(const VF* values) {
  const hn::Repartition<uint64_t, Floats> pairs;
  const VF second_half_of_four =
      hn::BitCast(kF, asInts(hn::Gt(hn::And(hn::Iota(kI, 0), hn::Set(kI, 2)), hn::Zero(kI))));
  VF within[kParts], last[kParts];
  for (int32_t p = 0; p < kParts; ++p) {
    VF z = values[p];
    z = hn::Add(z, hn::BitCast(kF, hn::ShiftLeft<32>(hn::BitCast(pairs, z))));
    z = hn::Add(z, hn::And(hn::BitCast(kF, hn::Broadcast<1>(hn::BitCast(kI, z))), second_half_of_four));
    within[p] = z;
    last[p] = hn::BitCast(kF, hn::Broadcast<3>(hn::BitCast(kI, z)));
  }
  Prefix out;
#if HWY_TARGET == HWY_AVX2
  const VF upper = hn::BitCast(kF, asInts(hn::Gt(hn::Iota(kI, 0), hn::Set(kI, 3))));
  const VF swapped = hn::ConcatLowerUpper(kF, last[0], last[0]);
  const VF before = hn::And(swapped, upper);
  out.total = hn::Add(last[0], swapped);
  out.inclusive[0] = hn::Add(within[0], before);
  out.exclusive[0] = hn::Add(hn::ShiftLeftLanes<1>(within[0]), before);
#else
  out.total = hn::Add(last[0], last[1]);
  out.inclusive[0] = within[0];
  out.exclusive[0] = hn::ShiftLeftLanes<1>(within[0]);
  out.inclusive[1] = hn::Add(within[1], last[0]);
  out.exclusive[1] = hn::Add(hn::ShiftLeftLanes<1>(within[1]), last[0]);
#endif
  return out;
}

#endif

Totals refreshTotals(const Table& table, const Chain* chains, int32_t num_chains, int32_t num_running,
                     int32_t* topic_counts, float* inverse) {
  const VF one = hn::Set(kF, 1.0F), beta_sum = hn::Set(kF, table.beta_sum);
  VF max_inverse = hn::Zero(kF);
  VI stale = hn::Zero(kI), confined = hn::Zero(kI);
  for (int32_t k = 0; k < table.num_vectors * kLanes; k += kWidth) {
    VI running = hn::Zero(kI);
    for (int32_t j = 0; j < num_running; ++j) running = hn::Add(running, hn::LoadU(kI, chains[j].counts + k));
    VI count = hn::Add(hn::LoadU(kI, table.outside + k), running);
    for (int32_t j = num_running; j < num_chains; ++j) {
      count = hn::Add(count, hn::LoadU(kI, chains[j].counts + k));
    }
    hn::StoreU(count, kI, topic_counts + k);
    const VF inv =
        hn::Mul(hn::Div(one, hn::Add(hn::ConvertTo(kF, count), beta_sum)), hn::LoadU(kF, table.eligible + k));
    hn::StoreU(inv, kF, inverse + k);
    max_inverse = hn::Max(max_inverse, inv);
    const VI open = hn::LoadU(kI, table.open + k);
    stale = hn::Or(stale, hn::Xor(open, asInts(hn::Gt(count, hn::Zero(kI)))));
    confined = hn::Or(confined, hn::And(open, asInts(hn::Eq(count, running))));
  }
  return {hn::GetLane(hn::MaxOfLanes(kF, max_inverse)), countTrue(stale) > 0, countTrue(confined) > 0};
}

// One token of one chain. kVectors 0: as many as the table says. False: it is to open a topic.
template <int32_t kVectors, bool kAllEligible>
HWY_INLINE bool draw(const Table& table, const float* HWY_RESTRICT inverse, Chain& chain, VF* suffix,
                     VI* word_counts, VI* cell_counts) {
  const int32_t num_vectors = kVectors > 0 ? kVectors : table.num_vectors;
  const int32_t at = chain.next;
  Token& token = chain.tokens[at];
  const int64_t stride = num_vectors * kLanes;
  int32_t* const row = table.word_counts + token.word * stride;
  int32_t* const counts = chain.counts;
  const float* const prior = chain.prior.data();
  const int32_t* const ahead =
      table.word_counts + chain.tokens[std::min(at + 6, chain.size - 1)].word * stride;
  const int64_t end = std::min<int64_t>(stride, 32);
  for (int64_t k = 0; k < end; k += 16) hwy::Prefetch(ahead + k);

  // Weights, and vertical sums from the last vector back: suffix[v] is the sum of those after v.
  const VI own = hn::Set(kI, token.slot);
  const VF beta = hn::Set(kF, table.beta);
  VF sum[kParts];
  for (int32_t v = num_vectors - 1; v >= 0; --v) {
    for (int32_t p = 0; p < kParts; ++p) {
      const int32_t k = v * kLanes + p * kWidth, i = v * kParts + p;
      const VI is_own = asInts(hn::Eq(own, hn::Iota(kI, k)));
      word_counts[i] = hn::Add(hn::LoadU(kI, row + k), is_own);
      cell_counts[i] = hn::Add(hn::LoadU(kI, counts + k), is_own);
      const VF of_word =
          hn::Mul(hn::Add(hn::ConvertTo(kF, word_counts[i]), beta), hn::LoadU(kF, inverse + k));
      const VF weight =
          hn::Mul(of_word, hn::Add(hn::ConvertTo(kF, cell_counts[i]), hn::LoadU(kF, prior + k)));
      if (v == num_vectors - 1) {
        suffix[i] = hn::Zero(kF);
        sum[p] = weight;
      } else {
        suffix[i] = sum[p];
        sum[p] = hn::Add(sum[p], weight);
      }
    }
  }
  const Prefix sums = prefix(sum);
  if constexpr (!kAllEligible) {
    const double mass = table.opening_mass;
    const auto total = static_cast<double>(hn::GetLane(sums.total));
    if (mass > 0.0 && chain.opening_uniforms[static_cast<size_t>(at)] * (total + mass) < mass) return false;
  }

  // The lane in which the point falls, then the vector.
  const VF point = hn::Mul(sums.total, hn::Set(kF, chain.uniforms[static_cast<size_t>(at)]));
  int32_t slot = 0;
  for (int32_t p = 0; p < kParts; ++p) {
    const VI passed = asInts(hn::Le(sums.inclusive[p], point));
    slot += countTrue(passed);
    VI rest = hn::AndNot(passed, asInts(hn::Le(sums.exclusive[p], point)));
    for (int32_t v = 0; v < num_vectors; ++v) {
      const int32_t k = v * kLanes + p * kWidth, i = v * kParts + p;
      VI drawn = rest;
      if (v < num_vectors - 1) {
        VI later = asInts(hn::Le(hn::Sub(sums.inclusive[p], suffix[i]), point));
        if constexpr (!kAllEligible) {
          later = hn::Or(later, asInts(hn::Eq(hn::LoadU(kF, inverse + k), hn::Zero(kF))));
        }
        drawn = hn::AndNot(later, rest);
        rest = hn::And(later, rest);
        slot += kLanes * countTrue(rest);
      }
      hn::StoreU(hn::Sub(word_counts[i], drawn), kI, row + k);
      hn::StoreU(hn::Sub(cell_counts[i], drawn), kI, counts + k);
    }
  }
  token.slot = slot;
  chain.next = at + 1;
  return true;
}

template <int32_t kVectors, bool kAllEligible>
int32_t drawRoundsOf(const Table& table, const float* inverse, Chain* chains, int32_t num_chains,
                     int32_t num_rounds) {
  constexpr int32_t kRoom = (kVectors > 0 ? kVectors : 1250) * kParts;  // 10000 topics
  VF suffix[kRoom];
  VI word_counts[kRoom], cell_counts[kRoom];
  for (int32_t round = 0; round < num_rounds; ++round) {
    for (int32_t j = 0; j < num_chains; ++j) {
      if (!draw<kVectors, kAllEligible>(table, inverse, chains[j], suffix, word_counts, cell_counts))
        return j;
    }
  }
  return -1;
}

template <int32_t kVectors>
int32_t drawRoundsOf(const Table& table, const float* inverse, Chain* chains, int32_t num_chains,
                     int32_t num_rounds) {
  return table.all_eligible ? drawRoundsOf<kVectors, true>(table, inverse, chains, num_chains, num_rounds)
                            : drawRoundsOf<kVectors, false>(table, inverse, chains, num_chains, num_rounds);
}

int32_t drawRoundsHere(const Table& table, const float* inverse, Chain* chains, int32_t num_chains,
                       int32_t num_rounds) {
  switch (table.num_vectors) {
    case 1:
      return drawRoundsOf<1>(table, inverse, chains, num_chains, num_rounds);
    case 2:
      return drawRoundsOf<2>(table, inverse, chains, num_chains, num_rounds);
    case 3:
      return drawRoundsOf<3>(table, inverse, chains, num_chains, num_rounds);
    case 4:
      return drawRoundsOf<4>(table, inverse, chains, num_chains, num_rounds);
    default:
      return drawRoundsOf<0>(table, inverse, chains, num_chains, num_rounds);
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace shoal::topics
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace shoal::topics {

HWY_EXPORT(refreshTotals);
HWY_EXPORT(drawRoundsHere);

Totals refresh(const Table& table, const Chain* chains, int32_t num_chains, int32_t num_running,
               int32_t* topic_counts, float* inverse) {
  return HWY_DYNAMIC_DISPATCH(refreshTotals)(table, chains, num_chains, num_running, topic_counts, inverse);
}

int32_t drawRounds(const Table& table, const float* inverse, Chain* chains, int32_t num_chains,
                   int32_t num_rounds) {
  return HWY_DYNAMIC_DISPATCH(drawRoundsHere)(table, inverse, chains, num_chains, num_rounds);
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
