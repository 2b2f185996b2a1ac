// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/vocabulary.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>

#include "shoal/vision/little_endian.h"

namespace shoal::vision {
namespace {

constexpr std::string_view kMagic = "SHOALVOC";
constexpr uint64_t kFormatVersion = 1;
constexpr uint64_t kMaxWords = 65536;
constexpr size_t kHeaderBytes = 24;
constexpr size_t kChecksumBytes = 8;

// The second block of the header: version in the low half, bits a word in the high half.
constexpr uint64_t kFormat = kFormatVersion | uint64_t{kBinaryWordBits} << 32;

std::vector<uint8_t> serializeWithoutChecksum(std::span<const BinaryWord> words) {
  std::vector<uint8_t> bytes;
  bytes.reserve(kHeaderBytes + kBinaryWordBytes * words.size() + kChecksumBytes);
  bytes.assign(kMagic.begin(), kMagic.end());
  appendLittleEndian64(bytes, kFormat);
  appendLittleEndian64(bytes, words.size());
  for (const BinaryWord& word : words) {
    for (const uint64_t part : word) appendLittleEndian64(bytes, part);
  }
  return bytes;
}

[[noreturn]] void refuse(const std::string& what) { throw std::invalid_argument("vocabulary: " + what); }

}  // namespace

Vocabulary::Vocabulary(std::vector<BinaryWord> words) : words_(std::move(words)) {
  if (words_.empty() || words_.size() > kMaxWords) {
    refuse("must have 1 to " + std::to_string(kMaxWords) + " words, got " + std::to_string(words_.size()));
  }
  fingerprint_ = checksum(serializeWithoutChecksum(words_));
}

Vocabulary Vocabulary::parse(std::span<const uint8_t> bytes) {
  if (bytes.size() < kHeaderBytes)
    refuse("truncated, " + std::to_string(bytes.size()) + " bytes have no header");
  if (!std::equal(kMagic.begin(), kMagic.end(), bytes.begin())) {
    refuse("not a vocabulary file, it does not begin with \"" + std::string(kMagic) + "\"");
  }
  const uint64_t format = littleEndian64(&bytes[8]);
  if (format != kFormat) {
    refuse("format version " + std::to_string(format & 0xffffffffu) + " with " +
           std::to_string(format >> 32) + "-bit words; this build reads version 1 with 256-bit words");
  }
  const uint64_t num_words = littleEndian64(&bytes[16]);
  if (num_words == 0 || num_words > kMaxWords) {
    refuse("corrupt, it claims " + std::to_string(num_words) + " words; 1 to " + std::to_string(kMaxWords) +
           " are possible");
  }
  const size_t end_of_words = kHeaderBytes + kBinaryWordBytes * static_cast<size_t>(num_words);
  if (bytes.size() != end_of_words + kChecksumBytes) {
    refuse(std::string(bytes.size() < end_of_words + kChecksumBytes ? "truncated" : "too long") + ", " +
           std::to_string(num_words) + " words take " + std::to_string(end_of_words + kChecksumBytes) +
           " bytes, got " + std::to_string(bytes.size()));
  }
  if (checksum(bytes.first(end_of_words)) != littleEndian64(&bytes[end_of_words])) {
    refuse("corrupt, the checksum does not match");
  }
  std::vector<BinaryWord> words;
  words.reserve(static_cast<size_t>(num_words));
  for (size_t at = kHeaderBytes; at < end_of_words; at += kBinaryWordBytes)
    words.push_back(binaryWord(&bytes[at]));
  return Vocabulary(std::move(words));
}

std::vector<uint8_t> Vocabulary::serialize() const {
  std::vector<uint8_t> bytes = serializeWithoutChecksum(words_);
  appendLittleEndian64(bytes, fingerprint_);
  return bytes;
}

}  // namespace shoal::vision
