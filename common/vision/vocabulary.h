// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shoal/vision/binary_word.h"

namespace shoal::vision {

/// A list of binary visual words; a word's id is its index.
///
/// As bytes, all numbers little-endian:
///
///     offset       size   content
///     0            8      "SHOALVOC"
///     8            4      format version, 1
///     12           4      bits a word, 256
///     16           8      number of words n, 1 to 65536
///     24           32 n   the words, descriptor bytes in order
///     24 + 32 n    8      checksum of everything before it; also the fingerprint
///
/// Any single unlike byte changes the checksum for certain: it chains bijections over 8-byte blocks.
class Vocabulary {
 public:
  /// @throws std::invalid_argument unless there are 1 to 65536 words.
  explicit Vocabulary(std::vector<BinaryWord> words);

  /// Reads any bytes safely.
  /// @throws std::invalid_argument saying what is wrong: not a vocabulary, another version, truncated, too
  ///         long, or corrupt.
  static Vocabulary parse(std::span<const uint8_t> bytes);

  /// The bytes that parse() reads.
  std::vector<uint8_t> serialize() const;

  const std::vector<BinaryWord>& words() const { return words_; }
  int32_t size() const { return static_cast<int32_t>(words_.size()); }

  /// Equal for equal words, and almost surely only then.
  uint64_t fingerprint() const { return fingerprint_; }

 private:
  std::vector<BinaryWord> words_;
  uint64_t fingerprint_;
};

}  // namespace shoal::vision
