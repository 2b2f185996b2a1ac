// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/dense_vocabulary.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "shoal/vision/dense_features.h"
#include "shoal/vision/little_endian.h"

namespace shoal::vision {
namespace {

constexpr std::string_view kMagic = "SHOALDEN";
constexpr uint64_t kFormatVersion = 1;
constexpr size_t kHeaderBytes = 24;
constexpr size_t kListHeaderBytes = 16;
constexpr size_t kNameBytes = 8;
constexpr size_t kChecksumBytes = 8;
constexpr uint64_t kMaxLists = 16;
constexpr uint64_t kMaxDimensions = 32;  // so that squared distances stay below 2^31
constexpr uint64_t kMaxWords = 65536;

[[noreturn]] void refuse(const std::string& what) {
  throw std::invalid_argument("dense vocabulary: " + what);
}

void checkHeader(const std::string& name, uint64_t dimensions, uint64_t num_words) {
  const bool spelt =
      std::ranges::all_of(name, [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); });
  if (name.empty() || name.size() > kNameBytes || !spelt) {
    refuse("a list must have a name of 1 to 8 characters in [a-z0-9]");
  }
  if (dimensions < 1 || dimensions > kMaxDimensions) {
    refuse(name + " must have 1 to 32 dimensions, got " + std::to_string(dimensions));
  }
  if (num_words < 1 || num_words > kMaxWords) {
    refuse(name + " must have 1 to 65536 words, got " + std::to_string(num_words));
  }
}

void check(const DenseWordList& list) {
  const auto dimensions = static_cast<uint64_t>(std::max(list.dimensions, 0));
  checkHeader(list.name, dimensions, dimensions > 0 ? list.words.size() / dimensions : 0);
  if (list.words.size() % dimensions != 0) {
    refuse(list.name + " has " + std::to_string(list.words.size()) + " values, not a multiple of its " +
           std::to_string(dimensions) + " dimensions");
  }
  for (const int16_t value : list.words) {
    if (value < -kMaxFeature || value > kMaxFeature) {
      refuse(list.name + " has the value " + std::to_string(value) + "; -" + std::to_string(kMaxFeature) +
             " to " + std::to_string(kMaxFeature) + " are possible");
    }
  }
}

size_t paddedBytes(size_t num_values) { return (2 * num_values + 7) / 8 * 8; }

std::vector<uint8_t> serializeWithoutChecksum(std::span<const DenseWordList> lists) {
  std::vector<uint8_t> bytes(kMagic.begin(), kMagic.end());
  appendLittleEndian64(bytes, kFormatVersion);
  appendLittleEndian64(bytes, lists.size());
  for (const DenseWordList& list : lists) {
    bytes.insert(bytes.end(), list.name.begin(), list.name.end());
    bytes.insert(bytes.end(), kNameBytes - list.name.size(), 0);
    appendLittleEndian64(
        bytes, static_cast<uint64_t>(list.dimensions) | static_cast<uint64_t>(list.numWords()) << 32);
  }
  for (const DenseWordList& list : lists) {
    for (const int16_t value : list.words) {
      const auto bits = static_cast<uint16_t>(value);
      bytes.push_back(static_cast<uint8_t>(bits));
      bytes.push_back(static_cast<uint8_t>(bits >> 8));
    }
    bytes.insert(bytes.end(), paddedBytes(list.words.size()) - 2 * list.words.size(), 0);
  }
  return bytes;
}

DenseWordList parseListHeader(std::span<const uint8_t> bytes) {
  DenseWordList list;
  const auto name = bytes.first(kNameBytes);
  list.name.assign(name.begin(), std::ranges::find(name, uint8_t{0}));
  const uint64_t sizes = littleEndian64(&bytes[kNameBytes]);
  const uint64_t dimensions = sizes & 0xffffffffu, num_words = sizes >> 32;
  checkHeader(list.name, dimensions, num_words);
  list.dimensions = static_cast<int>(dimensions);
  list.words.resize(static_cast<size_t>(dimensions * num_words));
  return list;
}

}  // namespace

DenseVocabulary::DenseVocabulary(std::vector<DenseWordList> lists) : lists_(std::move(lists)) {
  if (lists_.empty() || lists_.size() > kMaxLists) {
    refuse("must have 1 to 16 lists, got " + std::to_string(lists_.size()));
  }
  for (const DenseWordList& list : lists_) check(list);
  fingerprint_ = checksum(serializeWithoutChecksum(lists_));
}

DenseVocabulary DenseVocabulary::parse(std::span<const uint8_t> bytes) {
  const auto demandSize = [&](size_t least) {
    if (bytes.size() < least) {
      refuse("truncated, at least " + std::to_string(least) + " bytes were due, got " +
             std::to_string(bytes.size()));
    }
  };
  demandSize(kHeaderBytes + kChecksumBytes);
  if (!std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
    refuse("not a dense vocabulary file, it does not begin with \"" + std::string(kMagic) + "\"");
  }
  if (const uint64_t version = littleEndian64(&bytes[8]); version != kFormatVersion) {
    refuse("format version " + std::to_string(version) + "; this build reads version 1");
  }
  const uint64_t num_lists = littleEndian64(&bytes[16]);
  if (num_lists < 1 || num_lists > kMaxLists) {
    refuse("corrupt, it claims " + std::to_string(num_lists) + " lists; 1 to 16 are possible");
  }
  size_t at = kHeaderBytes + kListHeaderBytes * static_cast<size_t>(num_lists);
  demandSize(at + kChecksumBytes);
  // Before anything is allocated: the sizes that the lists claim must be those of the file.
  std::vector<std::span<const uint8_t>> headers;
  for (size_t n = 0; n < num_lists; ++n)
    headers.push_back(bytes.subspan(kHeaderBytes + n * kListHeaderBytes, kListHeaderBytes));
  size_t due = at + kChecksumBytes;
  for (const auto header : headers) {
    const uint64_t sizes = littleEndian64(&header[kNameBytes]);
    const uint64_t dimensions = sizes & 0xffffffffu, num_words = sizes >> 32;
    if (dimensions > kMaxDimensions || num_words > kMaxWords)
      refuse("corrupt, a list claims impossible sizes");
    due += paddedBytes(static_cast<size_t>(dimensions * num_words));
  }
  demandSize(due);
  if (bytes.size() > due) {
    refuse("too long, " + std::to_string(due) + " bytes were due, got " + std::to_string(bytes.size()));
  }
  if (checksum(bytes.first(due - kChecksumBytes)) != littleEndian64(&bytes[due - kChecksumBytes])) {
    refuse("corrupt, the checksum does not match");
  }
  std::vector<DenseWordList> lists;
  for (const auto header : headers) {
    DenseWordList& list = lists.emplace_back(parseListHeader(header));
    for (size_t n = 0; n < list.words.size(); ++n) {
      list.words[n] = static_cast<int16_t>(bytes[at + 2 * n] | bytes[at + 2 * n + 1] << 8);
    }
    at += paddedBytes(list.words.size());
  }
  return DenseVocabulary(std::move(lists));
}

std::vector<uint8_t> DenseVocabulary::serialize() const {
  std::vector<uint8_t> bytes = serializeWithoutChecksum(lists_);
  appendLittleEndian64(bytes, fingerprint_);
  return bytes;
}

}  // namespace shoal::vision
