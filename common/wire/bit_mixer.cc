// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/bit_mixer.h"

#include <algorithm>

#include "shoal/demand.h"
#include "shoal/wire/range_coder.h"

namespace shoal::wire {
namespace {

constexpr int32_t kMaxOdds = 2047;

// 65536 / (1 + exp(-x)) at x = -8, -7.5, ... 8.
constexpr std::array<int32_t, 33> kSquash = {22,    36,    60,    98,    162,   267,   439,   720,   1179,
                                             1921,  3108,  4971,  7812,  11955, 17625, 24743, 32768, 40793,
                                             47911, 53581, 57724, 60565, 62428, 63615, 64357, 64816, 65097,
                                             65269, 65374, 65438, 65476, 65500, 65514};

constexpr uint32_t squashed(int32_t odds) {
  odds = std::clamp(odds, -kMaxOdds, kMaxOdds) + 2048;
  const auto i = static_cast<size_t>(odds >> 7);
  const int32_t rest = odds & 127;
  return static_cast<uint32_t>((kSquash[i] * (128 - rest) + kSquash[i + 1] * rest + 64) >> 7);
}

constexpr auto kStretch = [] {
  std::array<int16_t, 4096> table{};
  int32_t odds = -kMaxOdds;
  for (uint32_t p = 0; p < table.size(); ++p) {  // the least odds that reach the middle of the step
    while (odds < kMaxOdds && squashed(odds) < p * 16 + 8) ++odds;
    table[p] = static_cast<int16_t>(odds);
  }
  return table;
}();

constexpr int32_t stretched(uint32_t p) { return kStretch[std::min<uint32_t>(p >> 4, 4095)]; }

// How far an estimate is believed that has seen so many bits, of 256.
constexpr std::array<int32_t, 8> kBelief = {0, 110, 160, 190, 210, 225, 236, 245};

constexpr int kLearningShift = 15;
constexpr int32_t kFirstWeight = 14336;  // least bytes for six and seven contexts

}  // namespace

uint32_t squash(int32_t odds) { return squashed(odds); }

int32_t stretch(uint32_t p) { return stretched(p); }

BitMixer::BitMixer(size_t num_contexts, size_t num_sets)
    : num_contexts_(num_contexts), weights_(num_contexts * num_sets, kFirstWeight) {
  SHOAL_DEMAND(num_contexts >= 1 && num_contexts <= kMaxContexts);
}

template <typename Coder>
int BitMixer::code(Coder& coder, std::span<ContextBit* const> contexts, size_t set, int bit) {
  SHOAL_DEMAND(contexts.size() == num_contexts_);
  int32_t* const weights = weights_.data() + set * num_contexts_;
  std::array<int32_t, kMaxContexts> odds{};
  int64_t sum = 0;
  for (size_t k = 0; k < num_contexts_; ++k) {
    const ContextBit& context = *contexts[k];
    const int32_t belief = context.seen < kBelief.size() ? kBelief[context.seen] : 256;
    odds[k] = stretched(context.one) * belief / 256;
    sum += int64_t{weights[k]} * odds[k];
  }
  const auto mixed = static_cast<int32_t>(std::clamp<int64_t>(sum / 65536, -kMaxOdds, kMaxOdds));
  const auto one = static_cast<int32_t>(squashed(mixed));
  bit = coder.bit(static_cast<uint32_t>(65536 - std::clamp(one, 32, 65504)), bit);
  const int32_t error = (bit != 0 ? 65536 : 0) - one;
  for (size_t k = 0; k < num_contexts_; ++k) {
    weights[k] += static_cast<int32_t>(int64_t{odds[k]} * error / (1 << kLearningShift));
    contexts[k]->update(bit);
  }
  return bit;
}

template int BitMixer::code(Encoder&, std::span<ContextBit* const>, size_t, int);
template int BitMixer::code(Decoder&, std::span<ContextBit* const>, size_t, int);

}  // namespace shoal::wire
