// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace shoal::vision {

/// The words of one kind of feature: points in feature space. A word's id is its index.
struct DenseWordList {
  std::string name;            ///< 1 to 8 characters in [a-z0-9]
  int dimensions = 0;          ///< in [1, 32]
  std::vector<int16_t> words;  ///< words x dimensions, each in [-kMaxFeature, kMaxFeature] (dense_features.h)

  int32_t numWords() const { return static_cast<int32_t>(words.size()) / dimensions; }
  bool operator==(const DenseWordList&) const = default;
};

/// Several small vocabularies, one for each kind of dense feature.
///
/// As bytes, all numbers little-endian:
///
///     offset      size    content
///     0           8       "SHOALDEN"
///     8           8       format version, 1
///     16          8       number of lists n, 1 to 16
///     24          16 n    per list: name, 8 bytes, filled up with 0; dimensions d, 4 bytes; words w, 4 bytes
///     24 + 16 n           per list: 2 w d bytes, the words, signed; then 0 up to a multiple of 8
///     end - 8     8       checksum of everything before it; also the fingerprint
///
/// Any single unlike byte changes the checksum for certain: it chains bijections over 8-byte blocks.
class DenseVocabulary {
 public:
  /// @throws std::invalid_argument naming what is out of the ranges above.
  explicit DenseVocabulary(std::vector<DenseWordList> lists);

  /// Reads any bytes safely.
  /// @throws std::invalid_argument saying what is wrong: not a dense vocabulary, another version, truncated,
  ///         too long, or corrupt.
  static DenseVocabulary parse(std::span<const uint8_t> bytes);

  /// The bytes that parse() reads.
  std::vector<uint8_t> serialize() const;

  const std::vector<DenseWordList>& lists() const { return lists_; }

  /// Equal for equal lists, and almost surely only then.
  uint64_t fingerprint() const { return fingerprint_; }

 private:
  std::vector<DenseWordList> lists_;
  uint64_t fingerprint_;
};

}  // namespace shoal::vision
