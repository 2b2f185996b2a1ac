// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/topic_similarities.h"

#include "shoal/matching/discounted_similarity.h"
#include "shoal/matching/similarity.h"

namespace shoal::mapping {

VertexSimilarity similarityOf(const StackedTopics& stacked, const matching::MatcherOptions& options) {
  if (options.similarity == "discounted") {
    return [table = matching::discountedSimilarity(stacked.descriptors)](int i, int j) {
      return table.at(i, j) / 1e9;
    };
  }
  std::vector<const matching::Descriptor*> all;
  for (const auto& robot : stacked.descriptors.robots)
    for (const matching::Descriptor& topic : robot) all.push_back(&topic);
  const matching::Similarity similarity = matching::similarityNamed(options.similarity);
  return [all, similarity](int i, int j) {
    return similarity(*all.at(static_cast<size_t>(i)), *all.at(static_cast<size_t>(j)));
  };
}

}  // namespace shoal::mapping
