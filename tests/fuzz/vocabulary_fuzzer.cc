// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a vocabulary: refused with a reason, or read and written again as the same bytes. The checksum
// is put right for most inputs, with what a refused one says it should be, so that the fuzzer gets past it.
//
//     fuzz_vocabulary -max_total_time=60 -max_len=1024
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include "shoal/vision/vocabulary.h"

namespace {

using shoal::vision::BinaryWord;
using shoal::vision::Vocabulary;

constexpr size_t kHeaderBytes = 24, kWordBytes = 32;

std::optional<Vocabulary> read(std::span<const uint8_t> bytes) {
  try {
    return Vocabulary::parse(bytes);
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

// The same header and words, with the checksum that such words have.
std::vector<uint8_t> withChecksum(std::span<const uint8_t> bytes) {
  const size_t num_words = (bytes.size() - kHeaderBytes) / kWordBytes;
  std::vector<uint8_t> whole =
      Vocabulary(std::vector<BinaryWord>(std::max<size_t>(num_words, 1))).serialize();
  std::copy_n(bytes.begin() + kHeaderBytes, num_words * kWordBytes, whole.begin() + kHeaderBytes);
  std::vector<BinaryWord> words;
  for (size_t i = 0; i < num_words; ++i)
    words.push_back(shoal::vision::binaryWord(&whole[kHeaderBytes + i * kWordBytes]));
  if (!words.empty()) whole = Vocabulary(words).serialize();
  return whole;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  const std::span bytes(data, size);
  if (const auto vocabulary = read(bytes); vocabulary && !std::ranges::equal(vocabulary->serialize(), bytes))
    std::abort();
  if (size < kHeaderBytes) return 0;
  std::vector<uint8_t> whole = withChecksum(bytes);
  if (!read(whole)) std::abort();
  std::copy_n(data, kHeaderBytes, whole.begin());  // any header, words and checksum that fit each other
  if (const auto vocabulary = read(whole); vocabulary && vocabulary->serialize() != whole) std::abort();
  return 0;
}
