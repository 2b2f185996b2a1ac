// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "shoal/eval/team_learning.h"

namespace shoal::eval {

/// What a team that merges its models comes to.
struct MergedTeam {
  Score score;                    ///< of the fused map, labels of the merged model, newest robot wins
  double sent = 0, received = 0;  ///< bytes of topic models per robot, all headers counted
};

/// The earlier way to agree on labels (K. Doherty, G. Flaspohler, N. Roy, Y. Girdhar, ICRA 2018), as the
/// paper sums it up (Jamieson et al. 2021, §II): after every `exchange_every` images all robots send their
/// topics, each robot's are matched to the merged model by the Hungarian algorithm (L2 distance, no
/// rejection), the counts are summed, and the merged model goes back to every robot, which goes on learning
/// from it. The first robot's topics are the first merged model. Robots see exact counts; every robot is
/// taken to hear every exchange.
MergedTeam learnByMerging(const TeamWords& words, const LearningOptions& options, int32_t exchange_every);

}  // namespace shoal::eval
