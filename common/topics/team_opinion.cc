// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/team_opinion.h"

#include <algorithm>

#include "shoal/topics/fixed_log.h"

namespace shoal::topics {

TeamOpinion::TeamOpinion(const std::vector<world::WordGroup>& groups, double beta, const TeamTopics& team,
                         const std::map<int32_t, int32_t>& labels) {
  if (team.others.empty()) return;
  counts_.emplace(groups, static_cast<int32_t>(team.others.size()), beta);
  scores_.resize(static_cast<size_t>(counts_->stride()));
  std::map<world::RobotId, int32_t> robots;
  for (const TeamTopics::Foreign& topic : team.others) {
    counts_->add(topic.words, static_cast<int32_t>(topics_.size()));
    const auto label = labels.find(topic.label);
    const auto robot = robots.try_emplace(topic.robot, static_cast<int32_t>(robots.size())).first;
    topics_.push_back({robot->second, label == labels.end() ? -1 : label->second});
  }
  choice_.resize(robots.size());
}

void TeamOpinion::ask(std::span<const world::WordCount> words, int64_t num_words,
                      std::span<int64_t> log_likelihoods, std::span<int64_t> in_favour) {
  std::ranges::fill(in_favour, 0);
  if (!counts_) return;
  counts_->logLikelihoods(words, -1, scores_);
  std::ranges::fill(choice_, -1);
  for (size_t i = 0; i < topics_.size(); ++i) {
    int32_t& choice = choice_[static_cast<size_t>(topics_[i].robot)];
    if (choice < 0 || scores_[i] > scores_[static_cast<size_t>(choice)]) choice = static_cast<int32_t>(i);
    if (topics_[i].label < 0) continue;
    int64_t& best = log_likelihoods[static_cast<size_t>(topics_[i].label)];
    best = std::max(best, scores_[i]);
  }
  const auto num_robots = static_cast<int64_t>(choice_.size()) + 1;
  const int64_t strange = std::ranges::max(log_likelihoods) - kBitsOfAStranger * kLogOne * num_words;
  for (const int32_t choice : choice_) {
    const int32_t label = topics_[static_cast<size_t>(choice)].label;
    if (label >= 0 && scores_[static_cast<size_t>(choice)] > strange)
      in_favour[static_cast<size_t>(label)] += kBitsOfAll * kLogOne / num_robots;
  }
}

}  // namespace shoal::topics
