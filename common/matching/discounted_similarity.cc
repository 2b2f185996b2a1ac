// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/discounted_similarity.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "shoal/matching/row_products.h"

namespace shoal::matching {
namespace {

__extension__ using Wide = __int128;

constexpr int64_t kOne = int64_t{1} << 52;  // a probability of 1: every whole number below it is a double
constexpr int64_t kPriorWords = 100;
constexpr int kRootBits = 6;  // roots of probabilities have 26 bits; the lowest are dropped, 20 are kept

struct Group {
  int32_t first, end;
};

std::vector<Group> groupsOf(const DescriptorSet& topics) {
  std::vector<Group> groups;
  for (const int32_t first : topics.group_first) {
    if (!groups.empty()) groups.back().end = first;
    groups.push_back({first, topics.vocabulary_size});
  }
  if (groups.empty()) groups.push_back({0, topics.vocabulary_size});
  return groups;
}

// Calls visit(group, its entries, their sum) for every group of a topic.
template <class Visit>
void eachGroup(const Descriptor& topic, const std::vector<Group>& groups, Visit visit) {
  size_t begin = 0;
  for (size_t g = 0; g < groups.size(); ++g) {
    size_t end = begin;
    int64_t total = 0;
    while (end < topic.entries.size() && topic.entries[end].word < groups[g].end)
      total += topic.entries[end++].weight;
    visit(g, std::span(topic.entries).subspan(begin, end - begin), total);
    begin = end;
  }
}

int32_t root(int64_t probability) {
  return static_cast<int32_t>(std::sqrt(static_cast<double>(probability)) + 0.5) >> kRootBits;
}

// (weight * kOne + more) / whole for more in [0, 100 kOne]; by 64 bits where these are enough.
int64_t part(int64_t weight, int64_t more, int64_t whole) {
  constexpr int64_t kSmall = 1023;
  if (weight <= kSmall) return (weight * kOne + more) / whole;
  return static_cast<int64_t>((Wide{weight} * kOne + more) / whole);
}

// Mean probability of every word within its group, in parts of kOne.
std::vector<int64_t> background(const std::vector<const Descriptor*>& topics,
                                const std::vector<Group>& groups, size_t vocabulary) {
  std::vector<Wide> sum(vocabulary);
  std::vector<int64_t> votes(groups.size(), 1);  // in quarters; one for the uniform distribution
  for (const Group& g : groups) {
    for (int32_t w = g.first; w < g.end; ++w) sum[static_cast<size_t>(w)] = kOne / (g.end - g.first);
  }
  for (const Descriptor* topic : topics) {
    eachGroup(*topic, groups, [&](size_t g, std::span<const Descriptor::Entry> entries, int64_t total) {
      if (total > 0) votes[g] += 4;
      for (const Descriptor::Entry& e : entries)
        sum[static_cast<size_t>(e.word)] += 4 * Wide{part(e.weight, 0, total)};
    });
  }
  std::vector<int64_t> mean(vocabulary);
  for (size_t g = 0; g < groups.size(); ++g) {
    for (int32_t w = groups[g].first; w < groups[g].end; ++w)
      mean[static_cast<size_t>(w)] = static_cast<int64_t>(sum[static_cast<size_t>(w)] / votes[g]);
  }
  return mean;
}

// sqrt(φ) - sqrt(b) of one topic: whole numbers within ±2^20.
void contrast(const Descriptor& topic, const std::vector<Group>& groups, const std::vector<int64_t>& mean,
              const std::vector<int32_t>& root_of_mean, double* row) {
  eachGroup(topic, groups, [&](size_t g, std::span<const Descriptor::Entry> entries, int64_t total) {
    auto e = entries.begin();
    for (int32_t word = groups[g].first; word < groups[g].end; ++word) {
      const auto w = static_cast<size_t>(word);
      const int64_t weight = e != entries.end() && e->word == word ? e++->weight : 0;
      row[w] = root(part(weight, kPriorWords * mean[w], total + kPriorWords)) - root_of_mean[w];
    }
  });
}

}  // namespace

PairTable discountedSimilarity(const DescriptorSet& set) {
  std::vector<const Descriptor*> topics;
  for (const std::vector<Descriptor>& robot : set.robots)
    for (const Descriptor& topic : robot) topics.push_back(&topic);
  const std::vector<Group> groups = groupsOf(set);
  const auto vocabulary = static_cast<size_t>(set.vocabulary_size);
  const std::vector<int64_t> mean = background(topics, groups, vocabulary);

  std::vector<int32_t> root_of_mean;
  for (const int64_t m : mean) root_of_mean.push_back(root(m));

  WholeRows rows(topics.size(), vocabulary);
  for (size_t i = 0; i < topics.size(); ++i) contrast(*topics[i], groups, mean, root_of_mean, rows.row(i));
  constexpr size_t kBlock = WholeRows::kBlock;
  std::vector<double> length(rows.numBlocks() * kBlock);
  for (size_t block = 0; block < rows.numBlocks(); ++block) {
    const auto squares = rows.products(block, block);
    for (size_t k = 0; k < kBlock; ++k)
      length[block * kBlock + k] = std::sqrt(static_cast<double>(squares[k][k]));
  }

  PairTable table(static_cast<int>(topics.size()));
  const auto fill = [&](size_t a, size_t b) {
    const auto dot = rows.products(a, b);
    for (size_t i = a * kBlock; i < std::min(topics.size(), (a + 1) * kBlock); ++i) {
      for (size_t j = b * kBlock; j < std::min(i, (b + 1) * kBlock); ++j) {
        const double lengths = length[i] * length[j];
        const double cosine =
            lengths > 0 ? static_cast<double>(dot[i - a * kBlock][j - b * kBlock]) / lengths : 0.0;
        const double bounded = std::fmin(std::fmax(cosine, -1.0), 1.0);
        table.at(static_cast<int>(i), static_cast<int>(j)) = static_cast<int32_t>(std::lround(bounded * 1e9));
      }
    }
  };
  constexpr size_t kNear = 8;  // blocks that stay in a core's own cache while all others pass by
  for (size_t first = 0; first < rows.numBlocks(); first += kNear) {
    const size_t end = std::min(rows.numBlocks(), first + kNear);
    for (size_t b = 0; b < end; ++b)
      for (size_t a = std::max(first, b); a < end; ++a) fill(a, b);
  }
  return table;
}

}  // namespace shoal::matching
