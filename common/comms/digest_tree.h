// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace shoal::comms {

/// Keys are hashes of 40 bits: whose they are only their room knows.
inline constexpr int kKeyBits = 40;
inline constexpr int kTreeFanout = 16;
inline constexpr int kMaxTreeDepth = kKeyBits / 4;

/// A piece as it is compared: equal version, equal content. Newer versions are greater.
struct Leaf {
  uint64_t key = 0;  ///< below 2^40
  uint64_t version = 0;
  uint64_t hash = 0;  ///< of the content
  friend bool operator==(const Leaf&, const Leaf&) = default;
};

/// All keys whose first 4 x depth bits are `prefix`.
struct TreeNode {
  int depth = 0;  ///< in [0, kMaxTreeDepth]
  uint64_t prefix = 0;
  auto operator<=>(const TreeNode&) const = default;

  uint64_t firstKey() const { return prefix << (kKeyBits - 4 * depth); }
  uint64_t endKey() const { return (prefix + 1) << (kKeyBits - 4 * depth); }
  TreeNode child(int i) const { return {depth + 1, prefix << 4 | static_cast<uint64_t>(i)}; }
};

/// What is held of one share of a state, as a tree of 16 branches over the keys. The digest of a node is the
/// sum of the hashes below it, so the root's is that of the share, and two holders find what differs by
/// comparing downwards. Kept as a sorted list with running sums: a digest costs two binary searches.
class DigestTree {
 public:
  DigestTree() = default;

  /// @param leaves  In any order; of equal keys the first counts. Cost: O(n log n).
  explicit DigestTree(std::vector<Leaf> leaves);

  uint64_t digest(const TreeNode& node = {}) const;
  size_t size(const TreeNode& node = {}) const;

  /// The leaves below a node, ascending by key.
  std::span<const Leaf> leaves(const TreeNode& node = {}) const;
  std::optional<Leaf> find(uint64_t key) const;

 private:
  size_t firstFrom(uint64_t key) const;

  std::vector<Leaf> leaves_;      // ascending by key
  std::vector<uint64_t> before_;  // sum of the hashes of the leaves before the i-th
};

}  // namespace shoal::comms
