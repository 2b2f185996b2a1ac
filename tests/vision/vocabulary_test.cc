// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/vocabulary.h"

#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"
#include "shoal/vision/shipped_vocabulary.h"

namespace shoal::vision {
namespace {

std::vector<BinaryWord> randomWords(size_t count, uint64_t seed) {
  Random random(seed);
  std::vector<BinaryWord> words(count);
  for (BinaryWord& word : words) {
    for (uint64_t& part : word) part = random();
  }
  return words;
}

std::string complaintOf(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(VocabularyTest, ComesBackFromItsBytes) {
  const Vocabulary vocabulary(randomWords(9, 1));
  const Vocabulary again = Vocabulary::parse(vocabulary.serialize());
  EXPECT_EQ(again.words(), vocabulary.words());
  EXPECT_EQ(again.fingerprint(), vocabulary.fingerprint());
}

// The layout is a promise to files that exist: 24 bytes, 32 a word, 8.
TEST(VocabularyTest, HasTheBytesOfItsDocumentation) {
  const auto bytes = Vocabulary({{0x0807060504030201u, 0, 0, 0xff}}).serialize();
  ASSERT_EQ(bytes.size(), 64u);
  const std::vector<uint8_t> expected_header{'S', 'H', 'O', 'A', 'L', 'V', 'O', 'C', 1, 0, 0, 0,
                                             0,   1,   0,   0,   1,   0,   0,   0,   0, 0, 0, 0};
  EXPECT_EQ(std::vector<uint8_t>(bytes.begin(), bytes.begin() + 24), expected_header);
  const std::vector<uint8_t> first_part{1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(std::vector<uint8_t>(bytes.begin() + 24, bytes.begin() + 32), first_part);
  EXPECT_EQ(bytes[48], 0xff);
  EXPECT_EQ(binaryWord(&bytes[24]), (BinaryWord{0x0807060504030201u, 0, 0, 0xff}));
}

TEST(VocabularyTest, RefusesEveryTruncationAndExtension) {
  auto bytes = Vocabulary(randomWords(5, 2)).serialize();
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(Vocabulary::parse({bytes.data(), size}), std::invalid_argument) << size << " bytes";
  }
  bytes.push_back(0);
  EXPECT_NE(complaintOf([&] { Vocabulary::parse(bytes); }).find("too long"), std::string::npos);
}

TEST(VocabularyTest, RefusesEveryFlippedBit) {
  auto bytes = Vocabulary(randomWords(5, 3)).serialize();
  for (size_t i = 0; i < bytes.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes[i] = static_cast<uint8_t>(bytes[i] ^ (1 << bit));
      EXPECT_THROW(Vocabulary::parse(bytes), std::invalid_argument) << "byte " << i << " bit " << bit;
      bytes[i] = static_cast<uint8_t>(bytes[i] ^ (1 << bit));
    }
  }
  EXPECT_NO_THROW(Vocabulary::parse(bytes));
}

TEST(VocabularyTest, RefusesRandomBytes) {
  Random random(4);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<uint8_t> bytes(random.below(200));
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
    EXPECT_THROW(Vocabulary::parse(bytes), std::invalid_argument) << trial;
  }
}

TEST(VocabularyTest, SaysWhatIsWrong) {
  const auto good = Vocabulary(randomWords(2, 5)).serialize();
  auto bytes = good;
  bytes[0] = 'X';
  EXPECT_NE(complaintOf([&] { Vocabulary::parse(bytes); }).find("not a vocabulary"), std::string::npos);
  bytes = good;
  bytes[8] = 2;
  EXPECT_NE(complaintOf([&] { Vocabulary::parse(bytes); }).find("format version 2"), std::string::npos);
  bytes = good;
  bytes[30] ^= 1;
  EXPECT_NE(complaintOf([&] { Vocabulary::parse(bytes); }).find("checksum"), std::string::npos);
  EXPECT_NE(complaintOf([&] { Vocabulary::parse({good.data(), 60}); }).find("truncated"), std::string::npos);
}

// A count that would overflow or exhaust memory is refused before anything is allocated.
TEST(VocabularyTest, RefusesACountThatCannotBe) {
  auto bytes = Vocabulary(randomWords(2, 6)).serialize();
  for (size_t i = 16; i < 24; ++i) bytes[i] = 0xff;
  EXPECT_NE(complaintOf([&] { Vocabulary::parse(bytes); }).find("claims"), std::string::npos);
  for (size_t i = 16; i < 24; ++i) bytes[i] = 0;
  EXPECT_THROW(Vocabulary::parse(bytes), std::invalid_argument);
}

TEST(VocabularyTest, NeedsAtLeastOneWord) { EXPECT_THROW(Vocabulary({}), std::invalid_argument); }

TEST(VocabularyTest, HasAFingerprintOfItsWordsInOrder) {
  auto words = randomWords(3, 7);
  const uint64_t before = Vocabulary(words).fingerprint();
  std::swap(words[0], words[1]);
  EXPECT_NE(Vocabulary(words).fingerprint(), before);
}

TEST(ShippedVocabularyTest, HasFiveThousandDistinctWords) {
  const Vocabulary vocabulary = Vocabulary::parse(shippedOrbVocabulary());
  EXPECT_EQ(vocabulary.size(), 5000);
  EXPECT_EQ(std::set<BinaryWord>(vocabulary.words().begin(), vocabulary.words().end()).size(), 5000u);
}

}  // namespace
}  // namespace shoal::vision
