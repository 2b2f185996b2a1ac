// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/dense_vocabulary.h"

#include <functional>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"
#include "shoal/vision/dense_features.h"
#include "shoal/vision/shipped_vocabulary.h"

namespace shoal::vision {
namespace {

// Two lists whose values need padding to 8 bytes, one by 6 and one by 4.
std::vector<DenseWordList> lists() {
  return {{"lab24", 3, {1, -2, 3, 4095, -4095, 0, 7, 8, 9}}, {"chr", 2, {5, 6}}};
}

std::string complaint(const std::function<void()>& action) {
  try {
    action();
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no complaint";
}

TEST(DenseVocabularyTest, ComesBackFromItsBytes) {
  const DenseVocabulary vocabulary(lists());
  const DenseVocabulary again = DenseVocabulary::parse(vocabulary.serialize());
  EXPECT_EQ(again.lists(), lists());
  EXPECT_EQ(again.fingerprint(), vocabulary.fingerprint());
  EXPECT_EQ(again.lists()[0].numWords(), 3);
}

// The layout is a promise to files that exist.
TEST(DenseVocabularyTest, HasTheBytesOfItsDocumentation) {
  const auto bytes = DenseVocabulary(std::vector<DenseWordList>{{"ab", 2, {1, -2, 259, 4}}}).serialize();
  const std::vector<uint8_t> expected{
      'S', 'H', 'O', 'A', 'L', 'D', 'E', 'N', 1,   0,   0,    0,    0, 0, 0, 0,  //
      1,   0,   0,   0,   0,   0,   0,   0,   'a', 'b', 0,    0,    0, 0, 0, 0,  //
      2,   0,   0,   0,   2,   0,   0,   0,   1,   0,   0xfe, 0xff, 3, 1, 4, 0};
  ASSERT_EQ(bytes.size(), expected.size() + 8);
  EXPECT_EQ(std::vector<uint8_t>(bytes.begin(), bytes.end() - 8), expected);
}

TEST(DenseVocabularyTest, RefusesEveryTruncationAndExtension) {
  auto bytes = DenseVocabulary(lists()).serialize();
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_THROW(DenseVocabulary::parse({bytes.data(), size}), std::invalid_argument) << size << " bytes";
  }
  bytes.push_back(0);
  EXPECT_NE(complaint([&] { DenseVocabulary::parse(bytes); }).find("too long"), std::string::npos);
}

TEST(DenseVocabularyTest, RefusesEveryFlippedBit) {
  auto bytes = DenseVocabulary(lists()).serialize();
  for (size_t i = 0; i < bytes.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      bytes[i] = static_cast<uint8_t>(bytes[i] ^ (1 << bit));
      EXPECT_THROW(DenseVocabulary::parse(bytes), std::invalid_argument) << "byte " << i << " bit " << bit;
      bytes[i] = static_cast<uint8_t>(bytes[i] ^ (1 << bit));
    }
  }
  EXPECT_NO_THROW(DenseVocabulary::parse(bytes));
}

TEST(DenseVocabularyTest, RefusesRandomBytes) {
  Random random(4);
  for (int trial = 0; trial < 300; ++trial) {
    std::vector<uint8_t> bytes(random.below(200));
    for (uint8_t& byte : bytes) byte = static_cast<uint8_t>(random());
    EXPECT_THROW(DenseVocabulary::parse(bytes), std::invalid_argument) << trial;
  }
}

TEST(DenseVocabularyTest, SaysWhatIsWrong) {
  const auto good = DenseVocabulary(lists()).serialize();
  const auto changed = [&](size_t at, uint8_t value) {
    auto bytes = good;
    bytes[at] = value;
    return complaint([&] { DenseVocabulary::parse(bytes); });
  };
  EXPECT_NE(changed(0, 'X').find("not a dense vocabulary"), std::string::npos);
  EXPECT_NE(changed(8, 2).find("format version 2"), std::string::npos);
  EXPECT_NE(changed(16, 17).find("claims 17 lists"), std::string::npos);
  EXPECT_NE(changed(60, 1).find("checksum"), std::string::npos);
  EXPECT_NE(changed(36, 100).find("truncated"), std::string::npos);
  EXPECT_NE(changed(33, 1).find("impossible sizes"), std::string::npos);  // 259 dimensions
}

TEST(DenseVocabularyTest, RefusesListsOutOfRange) {
  const auto refused = [](std::vector<DenseWordList> bad, const std::string& what) {
    EXPECT_NE(complaint([&] { DenseVocabulary{bad}; }).find(what), std::string::npos) << what;
  };
  refused({}, "1 to 16 lists, got 0");
  refused(std::vector<DenseWordList>(17, {"a", 1, {1}}), "1 to 16 lists, got 17");
  refused({{"", 1, {1}}}, "name");
  refused({{"ninechars", 1, {1}}}, "name");
  refused({{"A", 1, {1}}}, "name");
  refused({{"a", 0, {1}}}, "1 to 32 dimensions, got 0");
  refused({{"a", -1, {1}}}, "1 to 32 dimensions, got 0");
  refused({{"a", 33, std::vector<int16_t>(33)}}, "1 to 32 dimensions, got 33");
  refused({{"a", 1, {}}}, "1 to 65536 words, got 0");
  refused({{"a", 2, {1, 2, 3}}}, "not a multiple");
  refused({{"a", 1, {4096}}}, "value 4096");
}

TEST(ShippedDenseVocabularyTest, HasDistinctWordsOfEveryKind) {
  const DenseVocabulary vocabulary = DenseVocabulary::parse(shippedDenseVocabulary());
  ASSERT_EQ(vocabulary.lists().size(), size_t{kNumFeatureKinds});
  for (size_t kind = 0; kind < kNumFeatureKinds; ++kind) {
    const DenseWordList& list = vocabulary.lists()[kind];
    EXPECT_EQ(list.name, kFeatureKinds[kind].name);
    EXPECT_EQ(list.dimensions, kFeatureKinds[kind].dimensions);
    EXPECT_EQ(list.numWords(), kFeatureKinds[kind].num_words);
    std::set<std::vector<int16_t>> distinct;
    for (auto word = list.words.begin(); word != list.words.end(); word += list.dimensions) {
      distinct.emplace(word, word + list.dimensions);
    }
    EXPECT_EQ(static_cast<int32_t>(distinct.size()), list.numWords()) << list.name;
  }
}

}  // namespace
}  // namespace shoal::vision
