// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/match_quality.h"

#include <map>
#include <utility>
#include <vector>

#include "shoal/demand.h"

namespace shoal::eval {
namespace {

double pairs(int n) { return 0.5 * n * (n - 1); }

double ratio(double part, double whole) { return whole > 0 ? part / whole : 1.0; }

}  // namespace

MatchQuality matchQuality(const TeamTally& tally, std::span<const int> label) {
  SHOAL_DEMAND(label.size() == tally.topics.size());
  const std::vector<int> truth = majorityClasses(tally);
  std::map<int, int> of_label, of_class;
  std::map<std::pair<int, int>, int> of_both;
  int topics = 0;
  for (size_t i = 0; i < label.size(); ++i) {
    if (truth[i] < 0) continue;
    ++topics;
    ++of_label[label[i]];
    ++of_class[truth[i]];
    ++of_both[{label[i], truth[i]}];
  }
  double told = 0, alike = 0, right = 0;  // pairs under one label, of one class, both
  for (const auto& [key, n] : of_label) told += pairs(n);
  for (const auto& [key, n] : of_class) alike += pairs(n);
  for (const auto& [key, n] : of_both) right += pairs(n);

  MatchQuality quality{.ari = 1, .precision = ratio(right, told), .recall = ratio(right, alike), .f1 = 0};
  quality.f1 = told + alike > 0 ? 2 * right / (told + alike) : 1.0;
  const double chance = pairs(topics) > 0 ? told * alike / pairs(topics) : 0.0;
  const double most = 0.5 * (told + alike);
  if (most > chance) quality.ari = (right - chance) / (most - chance);
  return quality;
}

}  // namespace shoal::eval
