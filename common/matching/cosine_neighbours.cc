// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/cosine_neighbours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#include "shoal/matching/similarity.h"

namespace shoal::matching {
namespace {

constexpr double kRoom = 1e-8;  // for the round-off of the bounds, and for cosine()'s own rounding

// A topic's share of a word, in its vector of length 1.
struct Share {
  size_t word = 0;  // its rank, rarest first
  double share = 0.0;
  double rest = 0.0;  // the norm of this share and those after it
};

// The topics that have each word: how many, and the ranks by that number, the rarest word first.
std::vector<size_t> ranksByRarity(const std::vector<const Descriptor*>& topics) {
  std::vector<int> holders;
  for (const Descriptor* topic : topics) {
    for (const Descriptor::Entry& e : topic->entries) {
      const auto word = static_cast<size_t>(e.word);
      if (word >= holders.size()) holders.resize(word + 1, 0);
      ++holders[word];
    }
  }
  std::vector<size_t> order(holders.size());
  for (size_t word = 0; word < order.size(); ++word) order[word] = word;
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return holders[a] < holders[b]; });
  std::vector<size_t> rank(order.size());
  for (size_t k = 0; k < order.size(); ++k) rank[order[k]] = k;
  return rank;
}

// The topic's shares, rarest word first.
std::vector<Share> sharesOf(const Descriptor& topic, const std::vector<size_t>& rank) {
  std::vector<Share> shares;
  double squares = 0.0;
  for (const Descriptor::Entry& e : topic.entries) {
    const auto weight = static_cast<double>(e.weight);
    shares.push_back({rank[static_cast<size_t>(e.word)], weight, 0.0});
    squares += weight * weight;
  }
  for (Share& s : shares) s.share /= std::sqrt(squares);
  std::sort(shares.begin(), shares.end(), [](const Share& a, const Share& b) { return a.word < b.word; });
  double rest = 0.0;
  for (auto s = shares.rbegin(); s != shares.rend(); ++s) {
    rest += s->share * s->share;
    s->rest = std::sqrt(rest);
  }
  return shares;
}

using Shares = std::vector<Share>::const_iterator;

double dotOf(Shares a, Shares a_end, Shares b, Shares b_end) {
  double dot = 0.0;
  while (a != a_end && b != b_end) {
    if (a->word == b->word) dot += a->share * b->share;
    const size_t at = std::min(a->word, b->word);
    a += a->word == at;
    b += b->word == at;
  }
  return dot;
}

}  // namespace

std::vector<std::pair<int, int>> cosineNeighbours(const std::vector<const Descriptor*>& topics,
                                                  double sigma) {
  struct Holder {
    int topic;
    double share;
  };
  const std::vector<size_t> rank = ranksByRarity(topics);
  std::vector<std::vector<Holder>> holders(rank.size());  // of each word, among the topics so far
  std::vector<double> dot(topics.size(), 0.0);            // of this topic with each, over the words looked up
  std::vector<int> met;                                   // the topics with one that is not 0
  std::vector<std::pair<int, int>> pairs;
  std::vector<std::vector<Share>> shares;  // of each topic so far
  for (size_t j = 0; j < topics.size(); ++j) {
    const std::vector<Share>& own = shares.emplace_back(sharesOf(*topics[j], rank));
    const auto aside =
        std::find_if(own.begin(), own.end(), [&](const Share& s) { return s.rest < sigma - kRoom; });
    const double own_aside = aside == own.end() ? 0.0 : aside->rest;
    const size_t from = aside == own.end() ? rank.size() : aside->word;
    met.clear();
    for (auto s = own.begin(); s != aside; ++s) {
      for (const Holder& other : holders[s->word]) {
        double& sum = dot[static_cast<size_t>(other.topic)];
        if (sum == 0.0) met.push_back(other.topic);
        sum += s->share * other.share;
      }
    }
    for (const int i : met) {
      const auto other = static_cast<size_t>(i);
      double sum = std::exchange(dot[other], 0.0);
      if (sum + own_aside < sigma - kRoom) continue;
      const auto first = std::lower_bound(shares[other].begin(), shares[other].end(), from,
                                          [](const Share& s, size_t word) { return s.word < word; });
      const double other_aside = first == shares[other].end() ? 0.0 : first->rest;
      if (sum + own_aside * other_aside < sigma - kRoom) continue;
      sum += dotOf(aside, own.end(), first, shares[other].end());
      if (sum < sigma - kRoom) continue;
      if (sum > sigma + kRoom || reaches(cosine(*topics[other], *topics[j]), sigma)) {
        pairs.emplace_back(i, static_cast<int>(j));
      }
    }
    for (const Share& s : own) holders[s.word].push_back({static_cast<int>(j), s.share});
  }
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

std::vector<std::pair<int, int>> cosineNeighboursOf(const std::vector<const Descriptor*>& topics,
                                                    const std::vector<int>& chosen, double sigma) {
  constexpr size_t kAtOnce = 4;  // chosen topics, side by side
  using Four = std::array<double, kAtOnce>;
  std::vector<double> length;
  int32_t num_words = 0;
  for (const Descriptor* topic : topics) {
    double squares = 0.0;
    for (const Descriptor::Entry& e : topic->entries)
      squares += static_cast<double>(e.weight) * static_cast<double>(e.weight);
    length.push_back(std::sqrt(squares));
    if (!topic->entries.empty()) num_words = std::max(num_words, topic->entries.back().word + 1);
  }
  std::vector<size_t> turn(topics.size(), chosen.size());  // of the chosen; the others come after all
  for (size_t k = 0; k < chosen.size(); ++k) turn[static_cast<size_t>(chosen[k])] = k;

  std::vector<std::pair<int, int>> pairs;
  for (size_t first = 0; first < chosen.size(); first += kAtOnce) {
    const size_t end = std::min(chosen.size(), first + kAtOnce);
    std::vector<Four> share(static_cast<size_t>(num_words), Four{});
    for (size_t k = first; k < end; ++k) {
      const auto own = static_cast<size_t>(chosen[k]);
      for (const Descriptor::Entry& e : topics[own]->entries)
        share[static_cast<size_t>(e.word)][k - first] = static_cast<double>(e.weight) / length[own];
    }
    for (size_t other = 0; other < topics.size(); ++other) {
      if (turn[other] <= first || topics[other]->entries.empty()) continue;  // has met all of these
      Four dot{};
      for (const Descriptor::Entry& e : topics[other]->entries) {
        const Four& shares = share[static_cast<size_t>(e.word)];
        const auto weight = static_cast<double>(e.weight);
        for (size_t k = 0; k < kAtOnce; ++k) dot[k] += shares[k] * weight;
      }
      for (size_t k = first; k < std::min(end, turn[other]); ++k) {
        const Descriptor& own = *topics[static_cast<size_t>(chosen[k])];
        const double product = dot[k - first] / length[other];
        if (own.entries.empty() || product < sigma - kRoom) continue;
        if (product > sigma + kRoom || reaches(cosine(own, *topics[other]), sigma))
          pairs.emplace_back(std::minmax(chosen[k], static_cast<int>(other)));
      }
    }
  }
  return pairs;
}

}  // namespace shoal::matching
