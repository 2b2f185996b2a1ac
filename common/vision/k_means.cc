// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/k_means.h"

#include <algorithm>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "shoal/demand.h"
#include "shoal/random.h"
#include "shoal/vision/dense_search.h"

namespace shoal::vision {
namespace {

// The points and their number of dimensions.
struct Points {
  std::span<const int16_t> values;
  size_t dimensions;

  size_t size() const { return values.size() / dimensions; }
  std::span<const int16_t> operator[](size_t i) const { return values.subspan(i * dimensions, dimensions); }
};

std::vector<int16_t> drawWords(const Points& points, const KMeansOptions& options) {
  Random random(options.seed);
  std::vector<int16_t> words;
  const auto take = [&](size_t i) { words.insert(words.end(), points[i].begin(), points[i].end()); };
  take(static_cast<size_t>(random.below(points.size())));
  std::vector<int32_t> distances(points.size(), INT32_MAX);
  for (int32_t k = 1; k < options.num_words; ++k) {
    const auto last = std::span<const int16_t>(words).last(points.dimensions);
    uint64_t sum = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      distances[i] = std::min(distances[i], squaredDistance(points[i], last));
      sum += static_cast<uint64_t>(distances[i]);
    }
    if (sum == 0) {
      throw std::invalid_argument("a vocabulary of " + std::to_string(options.num_words) +
                                  " words needs as many distinct points, got " + std::to_string(k));
    }
    uint64_t draw = random.below(sum);
    size_t i = 0;
    while (draw >= static_cast<uint64_t>(distances[i])) draw -= static_cast<uint64_t>(distances[i++]);
    take(i);
  }
  return words;
}

int16_t roundedMeanOf(int64_t sum, int64_t count) {
  const int64_t half = sum >= 0 ? count / 2 : -count / 2;
  return static_cast<int16_t>((sum + half) / count);
}

// The new words: the mean of each word's members, and for a word without any the farthest point that no other
// such word took.
std::vector<int16_t> update(const Points& points, std::span<const int32_t> assigned,
                            std::span<const int32_t> distances, size_t num_words) {
  std::vector<int64_t> sums(num_words * points.dimensions, 0), members(num_words, 0);
  for (size_t i = 0; i < points.size(); ++i) {
    const auto word = static_cast<size_t>(assigned[i]);
    ++members[word];
    for (size_t d = 0; d < points.dimensions; ++d) sums[word * points.dimensions + d] += points[i][d];
  }
  std::vector<size_t> farthest_first;
  if (std::ranges::find(members, 0) != members.end()) {
    farthest_first.resize(points.size());
    std::iota(farthest_first.begin(), farthest_first.end(), size_t{0});
    std::ranges::stable_sort(farthest_first, std::ranges::greater{}, [&](size_t i) { return distances[i]; });
  }
  std::vector<int16_t> updated(num_words * points.dimensions);
  size_t next = 0;
  for (size_t k = 0; k < num_words; ++k) {
    const auto word = updated.begin() + static_cast<ptrdiff_t>(k * points.dimensions);
    if (members[k] == 0) {
      std::ranges::copy(points[farthest_first[next++]], word);
      continue;
    }
    for (size_t d = 0; d < points.dimensions; ++d) {
      word[static_cast<ptrdiff_t>(d)] = roundedMeanOf(sums[k * points.dimensions + d], members[k]);
    }
  }
  return updated;
}

std::vector<int16_t> sorted(std::span<const int16_t> words, size_t dimensions) {
  std::vector<std::vector<int16_t>> rows;
  for (size_t at = 0; at < words.size(); at += dimensions) {
    const auto row = words.subspan(at, dimensions);
    rows.emplace_back(row.begin(), row.end());
  }
  std::ranges::sort(rows);
  std::vector<int16_t> result;
  for (const auto& row : rows) result.insert(result.end(), row.begin(), row.end());
  return result;
}

}  // namespace

KMeansResult kMeans(std::span<const int16_t> values, int dimensions, const KMeansOptions& options,
                    const std::function<void(int, int64_t, double)>& round_done) {
  SHOAL_DEMAND(dimensions >= 1 && dimensions <= 32 && values.size() % static_cast<size_t>(dimensions) == 0);
  const Points points{values, static_cast<size_t>(dimensions)};
  if (options.num_words < 1 || options.max_rounds < 1) {
    throw std::invalid_argument("num_words and max_rounds must be > 0, got " +
                                std::to_string(options.num_words) + " and " +
                                std::to_string(options.max_rounds));
  }
  if (points.size() == 0) throw std::invalid_argument("k-means needs points, got none");
  KMeansResult result{.words = drawWords(points, options), .rounds = 0, .mean_squared_distance = 0};
  std::vector<int32_t> assigned(points.size(), -1), distances(points.size());
  for (result.rounds = 1;; ++result.rounds) {
    const std::vector<int32_t> nearest = DenseSearch({"", dimensions, result.words}).nearest(values);
    int64_t changed = 0, sum = 0;
    for (size_t i = 0; i < points.size(); ++i) {
      const auto word = static_cast<size_t>(nearest[i]) * points.dimensions;
      distances[i] = squaredDistance(points[i], std::span(result.words).subspan(word, points.dimensions));
      changed += nearest[i] != assigned[i];
      sum += distances[i];
    }
    assigned = nearest;
    result.mean_squared_distance = static_cast<double>(sum) / static_cast<double>(points.size());
    if (round_done) round_done(result.rounds, changed, result.mean_squared_distance);
    if (changed == 0) break;
    result.words = update(points, assigned, distances, static_cast<size_t>(options.num_words));
    if (result.rounds == options.max_rounds) break;
  }
  result.words = sorted(result.words, points.dimensions);
  return result;
}

}  // namespace shoal::vision
