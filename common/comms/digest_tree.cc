// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/digest_tree.h"

#include <algorithm>

#include "shoal/demand.h"

namespace shoal::comms {

DigestTree::DigestTree(std::vector<Leaf> leaves) : leaves_(std::move(leaves)) {
  std::ranges::stable_sort(leaves_, {}, &Leaf::key);
  const auto same = [](const Leaf& a, const Leaf& b) { return a.key == b.key; };
  leaves_.erase(std::unique(leaves_.begin(), leaves_.end(), same), leaves_.end());
  SHOAL_DEMAND(leaves_.empty() || leaves_.back().key < uint64_t{1} << kKeyBits);
  before_.reserve(leaves_.size() + 1);
  before_.push_back(0);
  for (const Leaf& leaf : leaves_) before_.push_back(before_.back() + leaf.hash);
}

size_t DigestTree::firstFrom(uint64_t key) const {
  return static_cast<size_t>(std::ranges::lower_bound(leaves_, key, {}, &Leaf::key) - leaves_.begin());
}

uint64_t DigestTree::digest(const TreeNode& node) const {
  if (leaves_.empty()) return 0;
  return before_[firstFrom(node.endKey())] - before_[firstFrom(node.firstKey())];
}

size_t DigestTree::size(const TreeNode& node) const { return leaves(node).size(); }

std::span<const Leaf> DigestTree::leaves(const TreeNode& node) const {
  const size_t first = firstFrom(node.firstKey());
  return std::span(leaves_).subspan(first, firstFrom(node.endKey()) - first);
}

std::optional<Leaf> DigestTree::find(uint64_t key) const {
  const size_t at = firstFrom(key);
  if (at == leaves_.size() || leaves_[at].key != key) return std::nullopt;
  return leaves_[at];
}

}  // namespace shoal::comms
