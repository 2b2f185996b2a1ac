// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/bit_mixer.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "shoal/random.h"
#include "shoal/wire/context_table.h"
#include "shoal/wire/range_coder.h"

namespace shoal::wire {
namespace {

TEST(BitMixerTest, SquashIsTheLogisticFunction) {
  for (int odds = -2047; odds <= 2047; ++odds) {
    const double expected = 65536 / (1 + std::exp(-odds / 256.0));
    EXPECT_NEAR(squash(odds), expected, 24 + 0.032 * std::min(expected, 65536 - expected)) << odds;
  }
}

TEST(BitMixerTest, StretchUndoesSquash) {
  for (int odds = -1500; odds <= 1500; odds += 5) EXPECT_NEAR(stretch(squash(odds)), odds, 30) << odds;
  for (uint32_t p = 16; p < 65520; p += 16) EXPECT_LE(stretch(p), stretch(p + 16));
}

// One context knows the bit, the other is noise: the cost must come near the entropy of the first.
TEST(BitMixerTest, LearnsWhomToBelieve) {
  Random random(1);
  constexpr int kBits = 20000;
  std::vector<ContextBit> knowing(2), noise(16);
  BitMixer mixer(2, 1);
  Encoder encoder;
  std::vector<int> bits;
  std::vector<std::pair<size_t, size_t>> contexts;
  for (int i = 0; i < kBits; ++i) {
    const size_t hint = random.below(2);
    contexts.emplace_back(hint, random.below(16));
    bits.push_back(random.uniform() < 0.05 ? 1 - static_cast<int>(hint) : static_cast<int>(hint));
    const std::array<ContextBit*, 2> both = {&knowing[hint], &noise[contexts.back().second]};
    mixer.code(encoder, both, 0, bits.back());
  }
  const Bytes bytes = encoder.finish();
  const double entropy = -(0.05 * std::log2(0.05) + 0.95 * std::log2(0.95)) * kBits / 8;
  EXPECT_LT(static_cast<double>(bytes.size()), 1.08 * entropy);

  Decoder decoder(bytes);
  BitMixer again(2, 1);
  std::vector<ContextBit> knowing_again(2), noise_again(16);
  for (int i = 0; i < kBits; ++i) {
    const auto [hint, other] = contexts[static_cast<size_t>(i)];
    const std::array<ContextBit*, 2> both = {&knowing_again[hint], &noise_again[other]};
    ASSERT_EQ(again.code(decoder, both, 0, 0), bits[static_cast<size_t>(i)]);
  }
}

// A context that is left alone until the numbers of tables have come round is new all the same, whichever way
// they come round.
TEST(ContextTableTest, IsNewHoweverLongItsContextsWereLeftAlone) {
  for (size_t n = 0; n < 1000; ++n) {
    ContextTable table(1000);
    for (const size_t i : {n % 255, 300 + n % 256, 600 + n % 257, 900 + n % 3}) {
      ASSERT_EQ(table[i].one, ContextBit{}.one) << n;
      ASSERT_EQ(table[i].seen, 0) << n;
      table[i].update(1);
      ASSERT_EQ(table[i].seen, 1) << n;
    }
  }
}

TEST(ContextTableTest, TwoAtATimeDoNotMeet) {
  ContextTable one(50), other(50);
  one[7].update(1);
  EXPECT_EQ(one[7].seen, 1);
  EXPECT_EQ(other[7].seen, 0);
}

}  // namespace
}  // namespace shoal::wire
