// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/average_linkage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shoal/matching/clustering.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

PairTable randomTable(int n, uint64_t seed, int32_t steps) {
  Random random(seed);
  PairTable table(n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < i; ++j)
      table.at(i, j) =
          static_cast<int32_t>(random.below(static_cast<uint64_t>(steps)) * (1'000'000'000 / steps));
  return table;
}

std::vector<int> identity(int n) {
  std::vector<int> rank(static_cast<size_t>(n));
  std::iota(rank.begin(), rank.end(), 0);
  return rank;
}

std::vector<int> plain(const std::vector<int>& label) {
  return numberByFirstAppearance(label, static_cast<int>(label.size())).label;
}

// The definition, with sets of members and all pairs of clusters looked at every time.
std::vector<int> bruteForce(const PairTable& table, int64_t sigma, const PairConstraints& constraints) {
  std::vector<std::set<int>> clusters;
  for (int v = 0; v < table.size(); ++v) clusters.push_back({v});
  const auto clash = [&](const std::set<int>& a, const std::set<int>& b) {
    for (const auto& [i, j] : constraints.apart)
      if ((a.contains(i) && b.contains(j)) || (a.contains(j) && b.contains(i))) return true;
    return false;
  };
  const auto join = [&](size_t a, size_t b) {
    clusters[a].merge(clusters[b]);
    clusters.erase(clusters.begin() + static_cast<std::ptrdiff_t>(b));
  };
  for (const auto& [i, j] : constraints.together) {
    size_t a = 0, b = 0;
    for (size_t c = 0; c < clusters.size(); ++c) {
      if (clusters[c].contains(i)) a = c;
      if (clusters[c].contains(j)) b = c;
    }
    if (a != b) join(std::min(a, b), std::max(a, b));
  }
  while (true) {
    long double best = -2e9L;
    size_t first = 0, second = 0;
    for (size_t a = 0; a < clusters.size(); ++a) {
      for (size_t b = a + 1; b < clusters.size(); ++b) {
        if (clash(clusters[a], clusters[b])) continue;
        long double sum = 0;
        for (const int i : clusters[a])
          for (const int j : clusters[b]) sum += table.at(i, j);
        const long double mean = sum / static_cast<long double>(clusters[a].size() * clusters[b].size());
        if (mean > best) best = mean, first = a, second = b;
      }
    }
    if (best < static_cast<long double>(sigma)) break;
    join(first, second);
  }
  std::vector<int> label(static_cast<size_t>(table.size()));
  for (size_t c = 0; c < clusters.size(); ++c)
    for (const int v : clusters[c]) label[static_cast<size_t>(v)] = static_cast<int>(c);
  return label;
}

TEST(AverageLinkageTest, DoesWhatItsDefinitionSays) {
  for (uint64_t seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed + 1000);
    const int n = 1 + static_cast<int>(random.below(14));
    const PairTable table = randomTable(n, seed, seed % 2 == 0 ? 1'000'000'000 : 10);  // half have many ties
    PairConstraints constraints;
    for (int k = 0; n > 3 && k < static_cast<int>(seed % 4); ++k) {
      const int i = static_cast<int>(random.below(static_cast<uint64_t>(n)));
      const int j = static_cast<int>(random.below(static_cast<uint64_t>(n)));
      if (i != j) constraints.apart.emplace_back(i, j);
    }
    const int64_t sigma = static_cast<int64_t>(random.below(1'000'000'000));
    EXPECT_EQ(plain(averageLinkage(table, sigma, identity(n), constraints)),
              plain(bruteForce(table, sigma, constraints)));
  }
}

TEST(AverageLinkageTest, DependsOnRanksAndNotOnTheOrderOfTheVertices) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const int n = 12;
    const PairTable table = randomTable(n, seed, 8);
    std::vector<int> place = identity(n);  // vertex i goes to place[i]
    for (size_t i = place.size(); i > 1; --i) std::swap(place[i - 1], place[random.below(i)]);
    PairTable moved(n);
    std::vector<int> rank(place.size());
    for (int i = 0; i < n; ++i) {
      rank[static_cast<size_t>(place[static_cast<size_t>(i)])] = i;
      for (int j = 0; j < i; ++j)
        moved.at(place[static_cast<size_t>(i)], place[static_cast<size_t>(j)]) = table.at(i, j);
    }
    const std::vector<int> there = averageLinkage(moved, 600'000'000, rank);
    std::vector<int> back;
    for (int i = 0; i < n; ++i) back.push_back(there[static_cast<size_t>(place[static_cast<size_t>(i)])]);
    EXPECT_EQ(plain(back), plain(averageLinkage(table, 600'000'000, identity(n))));
  }
}

TEST(AverageLinkageTest, HonoursConstraintsWhateverTheSimilarities) {
  PairTable table(4);
  table.at(0, 1) = table.at(1, 2) = table.at(0, 2) = 900'000'000;
  EXPECT_EQ(plain(averageLinkage(table, 500'000'000, identity(4))), (std::vector{0, 0, 0, 1}));
  EXPECT_EQ(plain(averageLinkage(table, 500'000'000, identity(4), {{{0, 3}}, {{1, 2}}})),
            (std::vector{0, 1, 2, 0}));
  try {
    averageLinkage(table, 500'000'000, identity(4), {{{0, 1}, {1, 2}}, {{0, 2}}});
    FAIL() << "not refused";
  } catch (const std::invalid_argument& e) {
    EXPECT_NE(std::string(e.what()).find("1 and 2"), std::string::npos) << e.what();
  }
}

}  // namespace
}  // namespace shoal::matching
