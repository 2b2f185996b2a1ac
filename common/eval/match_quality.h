// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "shoal/eval/topic_tally.h"

namespace shoal::eval {

/// How well a matching groups a team's topics, cells left aside: every topic counts alike, and its truth is
/// the class of most of its cells. Topics without truth do not count.
struct MatchQuality {
  double ari = 0;  ///< adjusted Rand index (Hubert & Arabie 1985): 1 when equal, 0 as good as chance
  double precision =
      0;  ///< of the pairs of topics under one label, the share of one class; 1 when there are none
  double recall = 0;  ///< of the pairs of one class, the share under one label; 1 when there are none
  double f1 = 0;      ///< their harmonic mean
  bool operator==(const MatchQuality&) const = default;
};

/// @param label  One a topic of the tally, any numbers.
MatchQuality matchQuality(const TeamTally& tally, std::span<const int> label);

}  // namespace shoal::eval
