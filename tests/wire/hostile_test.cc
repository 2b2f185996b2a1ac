// SPDX-License-Identifier: BSD-3-Clause
// What may come from the network: every decoder, for all bytes, returns, and returns only what encodes to
// the same bytes.
#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <ostream>
#include <set>

#include "examples.h"
#include "shoal/wire/checksum.h"
#include "shoal/wire/message.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::wire {

void PrintTo(const Example& example, std::ostream* os) { *os << example.name; }

namespace {

Bytes readFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

// Bytes before the payload, from the lengths of docs/wire.md.
size_t documentedBytesOf(MessageKind kind) {
  switch (kind) {
    case MessageKind::kHeartbeat:
      return 142;
    case MessageKind::kTopics:
      return 45;
    case MessageKind::kBrick:
    case MessageKind::kCertainty:
      return 35;
    case MessageKind::kMatches:
      return 43;
    case MessageKind::kLabels:
      return 41;
    case MessageKind::kMap:
      return 57;
    case MessageKind::kPicture:
      return 62;
    case MessageKind::kSettings:
      return 57;
    case MessageKind::kEdit:
      return 60;
    case MessageKind::kRequest:
      return 27;
    case MessageKind::kRepair:
      return 28;
  }
  return 0;
}

void setLength(Bytes& bytes, size_t fixed, uint32_t n) {
  for (size_t i = 0; i < 4; ++i) bytes[fixed - 4 + i] = static_cast<uint8_t>(n >> (24 - 8 * i));
}

DecodeError errorOf(MessageKind kind, const Bytes& bytes) {
  DecodeError error{};
  EXPECT_TRUE(decodeAndEncode(kind, bytes, &error).empty()) << "accepted as " << channelKind(kind);
  return error;
}

// 1024 bricks of few cells, each between its floor and its ceiling: 4 million places in 578 bytes.
TEST(HostileTest, LooksForCellsInSoManyPlacesOnly) {
  const Bytes bytes = readFile(std::string(SHOAL_GOLDEN_DIR) + "/hostile/places.bin");
  ASSERT_EQ(bytes.size(), 578u);
  EXPECT_EQ(errorOf(MessageKind::kBrick, bytes), DecodeError::kBadPayload);
}

class GoldenTest : public testing::TestWithParam<Example> {};
INSTANTIATE_TEST_SUITE_P(All, GoldenTest, testing::ValuesIn(goldenExamples()),
                         [](const auto& instance) { return instance.param.name; });

// What is released can be read for ever: these files never change, and today's encoder still writes them.
TEST_P(GoldenTest, BytesAreThoseOfTheFile) {
  const Example example = GetParam();
  const Bytes golden = readFile(std::string(SHOAL_GOLDEN_DIR) + "/" + example.name + ".bin");
  ASSERT_FALSE(golden.empty()) << "no such file";
  EXPECT_EQ(example.bytes, golden);
  DecodeError error{};
  EXPECT_EQ(decodeAndEncode(example.kind, golden, &error).size(), golden.size()) << name(error);
}

TEST_P(GoldenTest, FixedFieldsTakeTheDocumentedBytes) {
  const Example example = GetParam();
  const size_t fixed = documentedBytesOf(example.kind);
  ASSERT_GE(example.bytes.size(), fixed);
  EXPECT_EQ(bigEndian(std::span(example.bytes).subspan(fixed - 4, 4)), example.bytes.size() - fixed);
}

TEST_P(GoldenTest, EveryTruncationIsRefused) {
  const Example example = GetParam();
  for (size_t size = 0; size < example.bytes.size(); ++size) {
    const Bytes cut(example.bytes.begin(), example.bytes.begin() + static_cast<ptrdiff_t>(size));
    const DecodeError error = errorOf(example.kind, cut);
    EXPECT_TRUE(error == DecodeError::kTooShort || error == DecodeError::kBadLength)
        << size << ": " << name(error);
  }
}

// Truncated with a length and a checksum to match: the payload ends early.
TEST_P(GoldenTest, EveryTruncationOfThePayloadIsRefusedEvenWithALengthToMatch) {
  const Example example = GetParam();
  const size_t fixed = documentedBytesOf(example.kind);
  for (size_t size = fixed; size < example.bytes.size(); ++size) {
    Bytes cut(example.bytes.begin(), example.bytes.begin() + static_cast<ptrdiff_t>(size));
    setLength(cut, fixed, static_cast<uint32_t>(size - fixed));
    writeChecksum(cut, fixed);
    const Bytes again = decodeAndEncode(example.kind, cut);
    EXPECT_TRUE(again.empty() || again == cut) << size;
    EXPECT_NE(again, example.bytes);
  }
}

TEST_P(GoldenTest, EveryFlippedBitIsRefused) {
  const Example example = GetParam();
  for (size_t bit = 0; bit < 8 * example.bytes.size(); ++bit) {
    Bytes flipped = example.bytes;
    flipped[bit / 8] ^= static_cast<uint8_t>(1 << (bit % 8));
    errorOf(example.kind, flipped);
  }
}

// With the checksum repaired, as an attacker would: refused, or a value that is exactly these bytes.
TEST_P(GoldenTest, EveryFlippedBitWithARightChecksumIsRefusedOrAnotherValue) {
  const Example example = GetParam();
  const size_t fixed = documentedBytesOf(example.kind);
  int accepted = 0;
  for (size_t bit = 0; bit < 8 * example.bytes.size(); ++bit) {
    Bytes flipped = example.bytes;
    flipped[bit / 8] ^= static_cast<uint8_t>(1 << (bit % 8));
    writeChecksum(flipped, fixed);
    const Bytes again = decodeAndEncode(example.kind, flipped);
    if (again.empty()) continue;
    ++accepted;
    EXPECT_EQ(again, flipped) << "bit " << bit;
  }
  EXPECT_GT(accepted, 0);  // mission and time may be anything
}

TEST_P(GoldenTest, CraftedMessagesAreRefusedByReason) {
  const Example example = GetParam();
  const size_t fixed = documentedBytesOf(example.kind);
  const auto crafted = [&](auto change) {
    Bytes bytes = example.bytes;
    change(bytes);
    return errorOf(example.kind, bytes);
  };
  EXPECT_EQ(errorOf(example.kind, {}), DecodeError::kTooShort);
  EXPECT_EQ(crafted([](Bytes& b) { b.resize(1); }), DecodeError::kTooShort);
  EXPECT_EQ(crafted([](Bytes& b) { b[0] ^= 1; }), DecodeError::kWrongType);
  EXPECT_EQ(crafted([](Bytes& b) { b.push_back(0); }), DecodeError::kTrailingBytes);
  EXPECT_EQ(crafted([](Bytes& b) { b.resize(kMaxMessageBytes + 1); }), DecodeError::kTooLong);
  EXPECT_EQ(crafted([](Bytes& b) { b.resize(65'499); }), DecodeError::kTooLong);
  for (const uint32_t n : {0xffffffffu, 0x80000000u, 2'000'000'000u, 300'000'000u, 100'000'000u, 65536u})
    EXPECT_EQ(crafted([&](Bytes& b) { setLength(b, fixed, n); }), DecodeError::kBadLength) << n;
  const bool is_empty = example.bytes.size() == fixed;  // of what is no more: 0 is its length
  if (!is_empty) {
    EXPECT_EQ(crafted([&](Bytes& b) { setLength(b, fixed, 0); }), DecodeError::kTrailingBytes);
  }
  for (const int other : {kFormat - 1, kFormat + 1})
    EXPECT_EQ(crafted([&](Bytes& b) { b[kFormatOffset] = static_cast<uint8_t>(other); }),
              DecodeError::kUnknownFormat);
  EXPECT_EQ(crafted([](Bytes& b) { b[19] ^= 4; }), DecodeError::kChecksum);
  EXPECT_EQ(crafted([](Bytes& b) { b[8] |= 0x80; }),
            DecodeError::kBadField);  // before the year 1970, so to say
  // As long as all that declare a payload, and nothing in it.
  if (!is_empty) {
    EXPECT_EQ(crafted([&](Bytes& b) {
                b.resize(fixed);
                setLength(b, fixed, 0);
              }),
              DecodeError::kChecksum);
  }
  // A channel of one kind that carries another.
  for (const Example& other : goldenExamples()) {
    if (other.kind != example.kind) {
      EXPECT_EQ(errorOf(other.kind, example.bytes), DecodeError::kWrongType);
    }
  }
}

// Payload bytes without sense behind good fields: returns, quickly, within the caps.
TEST_P(GoldenTest, RandomPayloadsAreRefusedOrAreAValue) {
  const Example example = GetParam();
  const size_t fixed = documentedBytesOf(example.kind);
  Random random(5);
  for (int trial = 0; trial < 3000; ++trial) {
    Bytes bytes(example.bytes.begin(), example.bytes.begin() + static_cast<ptrdiff_t>(fixed));
    const size_t size = random.below(trial % 10 == 0 ? kMaxMessageBytes - fixed : 40);
    for (size_t i = 0; i < size; ++i) {
      const auto byte = static_cast<uint8_t>(random());
      bytes.push_back(trial % 3 == 0 ? 0 : trial % 3 == 1 ? 0xff : byte);
    }
    // And counts without sense, in the bytes before the checksum.
    if (trial % 2 == 0) bytes[fixed - 7 - random.below(4)] = static_cast<uint8_t>(random());
    setLength(bytes, fixed, static_cast<uint32_t>(size));
    writeChecksum(bytes, fixed);
    (void)decodeAndEncode(example.kind, bytes);
  }
}

TEST(MessageKindTest, FingerprintsAndChannelsAreDistinctAndKnown) {
  std::set<int64_t> fingerprints;
  for (size_t k = 0; k < kNumMessageKinds; ++k) {
    const auto kind = static_cast<MessageKind>(k);
    EXPECT_TRUE(fingerprints.insert(fingerprintOf(kind)).second) << channelKind(kind);
    EXPECT_EQ(kindOf(fingerprintOf(kind)), kind);
    EXPECT_EQ(parseChannelKind(channelKind(kind)), kind);
  }
  EXPECT_FALSE(kindOf(0).has_value());
  EXPECT_FALSE(parseChannelKind("TOPIC").has_value());
}

TEST(PeekTest, ReadsTheFrontOfEveryMessage) {
  for (const Example& example : goldenExamples()) {
    const auto header = peek(example.bytes);
    ASSERT_TRUE(header.ok());
    EXPECT_EQ(header->kind, example.kind);
    EXPECT_EQ(header->mission, 20210529);
    EXPECT_EQ(header->time.us, example.kind == MessageKind::kHeartbeat ? 61'000'000 : 61'500'000);
  }
  EXPECT_EQ(peek({}).error(), DecodeError::kTooShort);
  EXPECT_EQ(peek(Bytes(20, 0)).error(), DecodeError::kWrongType);
}

// CRC-16/CCITT-FALSE of "123456789" is 0x29b1: the check value of every catalogue. Here behind two zeros'
// worth of checksum, by hand with the bitwise definition.
TEST(ChecksumTest, IsTheCatalogued) {
  Bytes message = {'1', '2', '3', '4', '5', '6', '7', '8', '9', 0xaa, 0xbb, 0, 0, 0, 0};
  unsigned crc = 0xffff;
  for (size_t i = 0; i < message.size(); ++i) {
    crc ^= static_cast<unsigned>(i == 9 || i == 10 ? 0 : message[i]) << 8;
    for (int bit = 0; bit < 8; ++bit) crc = ((crc & 0x8000) != 0 ? crc << 1 ^ 0x1021 : crc << 1) & 0xffff;
    if (i == 8) {
      EXPECT_EQ(crc, 0x29b1u);
    }
  }
  EXPECT_EQ(checksumOf(message, 15), crc);
  EXPECT_FALSE(hasRightChecksum(message, 15));
  writeChecksum(message, 15);
  EXPECT_TRUE(hasRightChecksum(message, 15));
}

}  // namespace
}  // namespace shoal::wire
