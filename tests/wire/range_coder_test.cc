// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/range_coder.h"

#include <gtest/gtest.h>

#include <cmath>

#include "shoal/random.h"
#include "shoal/wire/numbers.h"

namespace shoal::wire {
namespace {

// Bits of 40 contexts, each with a probability of its own, mixed with direct ones.
struct Message {
  std::vector<std::array<int, 2>> bits;  // context (-1: direct), bit
};

Message randomMessage(int length, Random& random) {
  Message message;
  for (int i = 0; i < length; ++i) {
    const int context = static_cast<int>(random.below(41)) - 1;
    const double p = context < 0 ? 0.5 : std::pow(context / 39.0, 4.0);  // many near 0, one exactly 0, one 1
    message.bits.push_back({context, random.uniform() < p ? 1 : 0});
  }
  return message;
}

Bytes encoded(const Message& message) {
  std::array<AdaptiveBit, 40> models;
  Encoder encoder;
  for (const auto& [context, bit] : message.bits) {
    if (context < 0) {
      encoder.direct(static_cast<uint64_t>(bit), 1);
    } else {
      encoder.bit(models[static_cast<size_t>(context)], bit);
    }
  }
  return encoder.finish();
}

TEST(RangeCoderTest, ReadsBackWhatItWrote) {
  Random random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const Message message = randomMessage(trial * trial / 20, random);
    const Bytes bytes = encoded(message);
    std::array<AdaptiveBit, 40> models;
    Decoder decoder(bytes);
    for (const auto& [context, bit] : message.bits) {
      const int read = context < 0 ? static_cast<int>(decoder.direct(0, 1))
                                   : decoder.bit(models[static_cast<size_t>(context)]);
      ASSERT_EQ(read, bit) << "trial " << trial;
    }
    EXPECT_FALSE(decoder.overrun());
  }
}

// Long runs of the likelier bit bring low to the brink of a carry: every length is a case of its own.
TEST(RangeCoderTest, CarriesRight) {
  for (int length = 0; length < 3000; length += 7) {
    Encoder encoder;
    AdaptiveBit model;
    for (int i = 0; i < length; ++i) encoder.bit(model, 1);
    encoder.bit(model, 0);
    encoder.direct(0x1ff, 9);
    const Bytes bytes = encoder.finish();
    Decoder decoder(bytes);
    AdaptiveBit reading;
    for (int i = 0; i < length; ++i) ASSERT_EQ(decoder.bit(reading), 1) << length;
    EXPECT_EQ(decoder.bit(reading), 0);
    EXPECT_EQ(decoder.direct(0, 9), 0x1ffu);
  }
}

// Shannon: n bits of which a share p are 1 cost at least n H(p); learning may cost a little more.
TEST(RangeCoderTest, CostsLittleMoreThanTheEntropy) {
  Random random(2);
  for (const double p : {0.01, 0.1, 0.3, 0.5}) {
    constexpr int kBits = 20000;
    Encoder encoder;
    AdaptiveBit model;
    int ones = 0;
    for (int i = 0; i < kBits; ++i) ones += encoder.bit(model, random.uniform() < p ? 1 : 0);
    const double share = static_cast<double>(ones) / kBits;
    const double entropy = kBits * (-share * std::log2(share) - (1 - share) * std::log2(1 - share)) / 8;
    EXPECT_LT(static_cast<double>(encoder.finish().size()), 1.03 * entropy + 10) << p;
  }
}

TEST(RangeCoderTest, SaysWhenTheStreamIsOver) {
  Decoder decoder({});
  EXPECT_EQ(decoder.direct(0, 8), 0u);
  EXPECT_TRUE(decoder.overrun() || decoder.direct(0, 63) == 0);
  decoder.direct(0, 63);
  EXPECT_TRUE(decoder.overrun());
}

TEST(RangeCoderTest, WritesNothingForNothing) { EXPECT_TRUE(Encoder().finish().empty()); }

// Exhaustive near 0 and at every power of two.
TEST(NumbersTest, ReadBackWhatTheyWrote) {
  std::vector<uint64_t> values;
  for (uint64_t v = 0; v < 300; ++v) values.push_back(v);
  for (int bits = 8; bits < 63; ++bits)
    for (const int64_t delta : {-1, 0, 1})
      values.push_back((uint64_t{1} << bits) + static_cast<uint64_t>(delta));
  Encoder encoder;
  SmallNumber small;
  LongNumber wide;
  BitTree tree(9);
  for (const uint64_t v : values) {
    codeWide(encoder, v);
    wide.code(encoder, v);
    if (v < (uint64_t{1} << 31)) small.code(encoder, static_cast<uint32_t>(v));
    if (v < 512) tree.code(encoder, static_cast<uint32_t>(v));
  }
  const Bytes bytes = encoder.finish();
  Decoder decoder(bytes);
  SmallNumber small_read;
  LongNumber wide_read;
  BitTree tree_read(9);
  for (const uint64_t v : values) {
    ASSERT_EQ(codeWide(decoder, 0), v);
    ASSERT_EQ(wide_read.code(decoder, 0), v);
    if (v < (uint64_t{1} << 31)) {
      ASSERT_EQ(small_read.code(decoder, 0), v);
    }
    if (v < 512) {
      ASSERT_EQ(tree_read.code(decoder, 0), v);
    }
  }
}

TEST(NumbersTest, ZigzagIsABijectionWithSmallMagnitudesFirst) {
  EXPECT_EQ(zigzag(0), 0u);
  EXPECT_EQ(zigzag(-1), 1u);
  EXPECT_EQ(zigzag(1), 2u);
  EXPECT_EQ(zigzag(-2), 3u);
  for (const int32_t v :
       {-1000, -63, 63, 1000, std::numeric_limits<int32_t>::min(), std::numeric_limits<int32_t>::max()})
    EXPECT_EQ(unzigzag(zigzag(v)), v);
}

TEST(BytesTest, VarintsReadBackAndRefuseToRunOver) {
  for (const uint64_t v : {uint64_t{0}, uint64_t{127}, uint64_t{128}, uint64_t{16383}, ~uint64_t{0}}) {
    Bytes bytes;
    putVarint(bytes, v);
    ByteReader reader(bytes);
    EXPECT_EQ(reader.varint(), v);
    EXPECT_FALSE(reader.failed());
    reader.varint();
    EXPECT_TRUE(reader.failed());
  }
  const Bytes endless(20, 0xff);
  ByteReader reader(endless);
  EXPECT_EQ(reader.varint(), 0u);
  EXPECT_TRUE(reader.failed());
}

}  // namespace
}  // namespace shoal::wire
