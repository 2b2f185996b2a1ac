// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/similarity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <stdexcept>
#include <utility>

#include "shoal/matching/fixed_log.h"

namespace shoal::matching {
namespace {

__extension__ using Wide = __int128;  // products of two weights or sums, at most 2^124

double nano(double x) { return std::nearbyint(std::clamp(x, 0.0, 1.0) * 1e9) / 1e9; }

int64_t total(const Descriptor& a) {
  int64_t sum = 0;
  for (const Descriptor::Entry& e : a.entries) sum += e.weight;
  return sum;
}

// Calls visit(weight in a, weight in b) for every word of either, ascending.
template <class Visit>
void zip(const Descriptor& a, const Descriptor& b, Visit visit) {
  auto x = a.entries.begin();
  auto y = b.entries.begin();
  while (x != a.entries.end() || y != b.entries.end()) {
    if (y == b.entries.end() || (x != a.entries.end() && x->word < y->word)) {
      visit(x++->weight, int64_t{0});
    } else if (x == a.entries.end() || y->word < x->word) {
      visit(int64_t{0}, y++->weight);
    } else {
      visit(x++->weight, y++->weight);
    }
  }
}

std::optional<double> ifEmpty(const Descriptor& a, const Descriptor& b) {
  if (a.entries.empty() && b.entries.empty()) return 1.0;
  if (a.entries.empty() || b.entries.empty()) return 0.0;
  return std::nullopt;
}

// x 2^50 as an integer: division, square root and rounding are the same wherever arithmetic is IEEE's.
int64_t scaled(double x) { return std::llround(x * 0x1p50); }

double share(Wide weight, int64_t sum) { return static_cast<double>(weight) / static_cast<double>(sum); }

constexpr std::array<std::pair<std::string_view, Similarity>, 6> kSimilarities{{{"cosine", &cosine},
                                                                                {"overlap", &overlap},
                                                                                {"l1", &l1},
                                                                                {"l2", &l2},
                                                                                {"hellinger", &hellinger},
                                                                                {"js", &jensenShannon}}};

}  // namespace

double cosine(const Descriptor& a, const Descriptor& b) {
  if (const auto value = ifEmpty(a, b)) return *value;
  Wide ab = 0;
  Wide aa = 0;
  Wide bb = 0;
  zip(a, b, [&](Wide x, Wide y) {
    ab += x * y;
    aa += x * x;
    bb += y * y;
  });
  return nano(static_cast<double>(ab) /
              (std::sqrt(static_cast<double>(aa)) * std::sqrt(static_cast<double>(bb))));
}

double overlap(const Descriptor& a, const Descriptor& b) {
  if (const auto value = ifEmpty(a, b)) return *value;
  const Wide total_a = total(a);
  const Wide total_b = total(b);
  Wide shared = 0;
  zip(a, b, [&](Wide x, Wide y) { shared += std::min(x * total_b, y * total_a); });
  return nano(static_cast<double>(shared) / static_cast<double>(total_a * total_b));
}

double l1(const Descriptor& a, const Descriptor& b) {
  if (const auto value = ifEmpty(a, b)) return *value;
  const Wide total_a = total(a);
  const Wide total_b = total(b);
  Wide apart = 0;
  zip(a, b, [&](Wide x, Wide y) {
    const Wide difference = x * total_b - y * total_a;
    apart += difference < 0 ? -difference : difference;
  });
  return nano(1.0 - static_cast<double>(apart) / (2.0 * static_cast<double>(total_a * total_b)));
}

double l2(const Descriptor& a, const Descriptor& b) {
  if (const auto value = ifEmpty(a, b)) return *value;
  const Wide total_a = total(a);
  const Wide total_b = total(b);
  const auto scale = static_cast<double>(total_a * total_b);
  double squares = 0.0;
  zip(a, b, [&](Wide x, Wide y) {
    const double difference = static_cast<double>(x * total_b - y * total_a) / scale;
    squares += difference * difference;
  });
  return nano(1.0 - std::sqrt(0.5 * squares));
}

double hellinger(const Descriptor& a, const Descriptor& b) {
  if (const auto value = ifEmpty(a, b)) return *value;
  const int64_t total_a = total(a);
  const int64_t total_b = total(b);
  Wide squares = 0;
  zip(a, b, [&](Wide x, Wide y) {
    const Wide difference = scaled(std::sqrt(share(x, total_a))) - scaled(std::sqrt(share(y, total_b)));
    squares += difference * difference;
  });
  return nano(1.0 - std::sqrt(static_cast<double>(squares) * 0x1p-101));
}

double jensenShannon(const Descriptor& a, const Descriptor& b) {
  if (const auto value = ifEmpty(a, b)) return *value;
  const int64_t total_a = total(a);
  const int64_t total_b = total(b);
  // p log2 p, and 0 where p is.
  const auto plogp = [](int64_t p) { return p == 0 ? Wide{0} : Wide{p} * fixedLog2(p); };
  Wide twice =
      0;  // Σ (a + b) times the entropy of the choice between a and b, which is 0 unless both are there
  zip(a, b, [&](Wide x, Wide y) {
    if (x == 0 || y == 0) return;
    const int64_t p = scaled(share(x, total_a));
    const int64_t q = scaled(share(y, total_b));
    twice += plogp(p + q) - plogp(p) - plogp(q);
  });
  return nano(static_cast<double>(twice) * 0x1p-51 / static_cast<double>(int64_t{1} << kLogBits));
}

bool reaches(double similarity, double sigma) {
  return std::llround(similarity * 1e9) >= std::llround(sigma * 1e9);
}

const std::vector<std::string>& similarityNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all;
    for (const auto& [name, function] : kSimilarities) all.emplace_back(name);
    return all;
  }();
  return names;
}

Similarity similarityNamed(std::string_view name) {
  for (const auto& [known, function] : kSimilarities) {
    if (known == name) return function;
  }
  std::string built;
  for (const std::string& known : similarityNames()) built += (built.empty() ? "" : ", ") + known;
  throw std::invalid_argument("similarity \"" + std::string(name) + "\" is not built; built are: " + built);
}

}  // namespace shoal::matching
