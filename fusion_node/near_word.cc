// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/near_word.h"

#include <algorithm>
#include <numeric>
#include <vector>

namespace shoal::fusion_node {
namespace {

// Letters to put in, take out or change (Levenshtein).
size_t lettersApart(const std::string& a, const std::string& b) {
  std::vector<size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), size_t{0});
  for (size_t i = 0; i < a.size(); ++i) {
    size_t above_left = row[0];
    row[0] = i + 1;
    for (size_t j = 0; j < b.size(); ++j) {
      const size_t above = row[j + 1];
      row[j + 1] = std::min({above + 1, row[j] + 1, above_left + (a[i] == b[j] ? 0 : 1)});
      above_left = above;
    }
  }
  return row.back();
}

}  // namespace

std::string nearest(const std::string& word, std::span<const std::string> known, size_t most) {
  std::string best;
  size_t least = most + 1;
  for (const std::string& one : known) {
    const size_t apart = lettersApart(word, one);
    if (apart >= least || apart >= word.size()) continue;
    least = apart;
    best = one;
  }
  return best;
}

}  // namespace shoal::fusion_node
