// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/neighbour_memory.h"

#include <algorithm>
#include <unordered_map>

#include "shoal/matching/cosine_neighbours.h"
#include "shoal/random.h"

namespace shoal::matching {
namespace {

using Pairs = std::vector<std::pair<int, int>>;

uint64_t hashOf(const Descriptor& topic) {
  uint64_t hash = topic.entries.size();
  for (const Descriptor::Entry& e : topic.entries)
    hash = mix64(hash ^ (static_cast<uint64_t>(e.word) << 40) ^ static_cast<uint64_t>(e.weight));
  return hash;
}

bool areAlike(const Descriptor& a, const Descriptor& b, Similarity similarity, double sigma) {
  return !a.entries.empty() && !b.entries.empty() && reaches(similarity(a, b), sigma);
}

// The pairs of a topic among `fresh` with any other, each once.
Pairs neighboursOf(const std::vector<const Descriptor*>& topics, const std::vector<int>& fresh,
                   Similarity similarity, double sigma) {
  if (similarity == &cosine) return cosineNeighboursOf(topics, fresh, sigma);
  std::vector<char> is_fresh(topics.size());
  for (const int i : fresh) is_fresh[static_cast<size_t>(i)] = 1;
  Pairs pairs;
  for (const int i : fresh) {
    for (int j = 0; j < static_cast<int>(topics.size()); ++j) {
      if (i == j || (is_fresh[static_cast<size_t>(j)] != 0 && j < i)) continue;  // two fresh ones meet once
      if (areAlike(*topics[static_cast<size_t>(i)], *topics[static_cast<size_t>(j)], similarity, sigma))
        pairs.emplace_back(std::minmax(i, j));
    }
  }
  return pairs;
}

}  // namespace

Pairs neighbours(const std::vector<const Descriptor*>& topics, Similarity similarity, double sigma) {
  if (similarity == &cosine) return cosineNeighbours(topics, sigma);
  Pairs pairs;
  for (size_t i = 0; i < topics.size(); ++i) {
    for (size_t j = i + 1; j < topics.size(); ++j) {
      if (areAlike(*topics[i], *topics[j], similarity, sigma))
        pairs.emplace_back(static_cast<int>(i), static_cast<int>(j));
    }
  }
  return pairs;
}

// Per topic the place among the last of one with the same words, each used once; -1 for those that are new.
std::vector<int> NeighbourMemory::placesBefore(const std::vector<const Descriptor*>& topics) const {
  std::unordered_multimap<uint64_t, int> place;  // looked up only, and content decides
  for (size_t i = topics_.size(); i-- > 0;) place.emplace(hashes_[i], static_cast<int>(i));
  std::vector<int> places;
  for (const Descriptor* topic : topics) {
    const auto [begin, end] = place.equal_range(hashOf(*topic));
    const auto same = std::find_if(begin, end, [&](const auto& entry) {
      return topics_[static_cast<size_t>(entry.second)].entries == topic->entries;
    });
    places.push_back(same == end ? -1 : same->second);
    if (same != end) place.erase(same);
  }
  return places;
}

// The pairs of two that were there before.
Pairs NeighbourMemory::pairsOfKnown(const std::vector<int>& before) const {
  std::vector<int> now(topics_.size(), -1);
  for (size_t i = 0; i < before.size(); ++i)
    if (before[i] >= 0) now[static_cast<size_t>(before[i])] = static_cast<int>(i);
  Pairs pairs;
  for (size_t i = 0; i < before.size(); ++i) {
    if (before[i] < 0) continue;
    for (const int other : neighbours_[static_cast<size_t>(before[i])]) {
      const int j = now[static_cast<size_t>(other)];
      if (j > static_cast<int>(i)) pairs.emplace_back(static_cast<int>(i), j);
    }
  }
  return pairs;
}

void NeighbourMemory::keep(const std::vector<const Descriptor*>& topics, const std::vector<int>& before,
                           const Pairs& pairs) {
  std::vector<Descriptor> kept;
  std::vector<uint64_t> hashes;
  for (size_t i = 0; i < topics.size(); ++i) {
    if (before[i] < 0) {
      kept.push_back(*topics[i]);
      hashes.push_back(hashOf(*topics[i]));
    } else {
      kept.push_back(std::move(topics_[static_cast<size_t>(before[i])]));
      hashes.push_back(hashes_[static_cast<size_t>(before[i])]);
    }
  }
  topics_ = std::move(kept);
  hashes_ = std::move(hashes);
  neighbours_.assign(topics.size(), {});
  for (const auto& [i, j] : pairs) {
    neighbours_[static_cast<size_t>(i)].push_back(j);
    neighbours_[static_cast<size_t>(j)].push_back(i);
  }
}

Pairs NeighbourMemory::pairs(const std::vector<const Descriptor*>& topics, Similarity similarity,
                             double sigma) {
  std::vector<int> before(topics.size(), -1);
  if (similarity == similarity_ && sigma == sigma_) before = placesBefore(topics);
  std::vector<int> fresh;
  for (size_t i = 0; i < before.size(); ++i)
    if (before[i] < 0) fresh.push_back(static_cast<int>(i));
  num_compared_ += std::ssize(fresh);
  Pairs pairs;
  if (3 * std::ssize(fresh) > std::ssize(topics)) {
    pairs = neighbours(topics, similarity, sigma);
  } else {
    pairs = pairsOfKnown(before);
    const Pairs found = neighboursOf(topics, fresh, similarity, sigma);
    pairs.insert(pairs.end(), found.begin(), found.end());
    std::ranges::sort(pairs);
  }
  similarity_ = similarity;
  sigma_ = sigma;
  keep(topics, before, pairs);
  return pairs;
}

}  // namespace shoal::matching
