// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/merging_team.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <utility>

#include "shoal/eval/piece_cost.h"
#include "shoal/eval/topic_tally.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/matching/hungarian.h"
#include "shoal/robot/explorer.h"

namespace shoal::eval {
namespace {

using Counts = std::map<int32_t, int64_t>;  // of a topic, by word

matching::Descriptor descriptor(const Counts& counts, int32_t slot) {
  matching::Descriptor d{.slot = slot, .entries = {}};
  for (const auto& [word, count] : counts) d.entries.push_back({word, count});
  return d;
}

Counts countsOf(const mapping::BelievedTopic& topic) {
  Counts counts;
  for (const world::WordCount& w : topic.words) counts[w.word] = w.count;
  return counts;
}

// Bytes that a model takes to send: its topics as pieces.
int64_t bytesOf(const std::vector<mapping::BelievedTopic>& model,
                const std::vector<world::WordGroup>& groups) {
  mapping::LocalBelief belief{.robot = {}, .version = {0, 0}, .groups = groups, .topics = model, .cells = {}};
  PieceCost cost;
  for (const mapping::Piece& whole : mapping::wholePieces(belief)) cost += costOf(whole);
  return cost.bytes;
}

class Team {
 public:
  Team(const TeamWords& words, const LearningOptions& options) : ids_(words.robots.size()) {
    for (size_t i = 0; i < words.robots.size(); ++i) {
      robots_.emplace_back(robot::ExplorerOptions{.robot = world::RobotId{static_cast<int32_t>(i)},
                                                  .profile = options.profile,
                                                  .seed = options.seed,
                                                  .cell_size_m = words.cell_size_m,
                                                  .hyperparameters = options.hyperparameters});
    }
  }

  robot::Explorer& robot(size_t i) { return robots_[i]; }
  std::vector<mapping::LocalBelief> beliefs() const {
    std::vector<mapping::LocalBelief> all;
    for (const robot::Explorer& robot : robots_) all.push_back(robot.belief());
    return all;
  }

  // Matches everybody's topics to the merged model, makes it anew, and says which of its topics each is.
  std::vector<std::map<world::TopicId, int>> merge(const std::vector<mapping::LocalBelief>& team) {
    std::vector<std::map<world::TopicId, int>> place;
    std::vector<Counts> sum = merged_;  // what later robots are matched to
    std::vector<Counts> fresh(sum.size());
    for (const mapping::LocalBelief& belief : team) {
      matching::DescriptorSet pair;
      pair.vocabulary_size = belief.groups.back().first + belief.groups.back().size;
      pair.robots.resize(2);
      for (size_t k = 0; k < sum.size(); ++k) {
        pair.robots[0].push_back(descriptor(sum[k], static_cast<int32_t>(k)));
      }
      for (const mapping::BelievedTopic& topic : belief.topics) {
        pair.robots[1].push_back(descriptor(countsOf(topic), number(topic.id)));
      }
      const std::vector<int> label = matching::matchSequentially(pair, matching::similarityNamed("l2")).label;
      std::map<world::TopicId, int>& own = place.emplace_back();
      for (size_t j = 0; j < belief.topics.size(); ++j) {
        const auto known =
            std::find(label.begin(), label.begin() + static_cast<ptrdiff_t>(pair.robots[0].size()),
                      label[pair.robots[0].size() + j]);
        auto k = static_cast<size_t>(known - label.begin());
        if (k == pair.robots[0].size()) {  // matched to none: new in the merged model
          k = sum.size();
          sum.emplace_back();
          fresh.emplace_back();
        }
        own.emplace(belief.topics[j].id, static_cast<int>(k));
        for (const world::WordCount& w : belief.topics[j].words) fresh[k][w.word] += w.count;
        if (merged_.size() <= k) sum[k] = fresh[k];
      }
    }
    merged_ = std::move(fresh);
    return place;
  }

  // Gives the merged model to every robot.
  void distribute(const std::vector<mapping::LocalBelief>& team,
                  const std::vector<std::map<world::TopicId, int>>& place) {
    for (size_t i = 0; i < robots_.size(); ++i) {
      std::vector<Counts> others = merged_;
      std::vector<std::optional<world::TopicId>> own(merged_.size());
      for (const auto& [k, id] : ids_[i]) own[k] = id;  // adopted before, perhaps without words of its own
      for (const mapping::BelievedTopic& topic : team[i].topics) {
        const auto k = static_cast<size_t>(place[i].at(topic.id));
        own[k] = topic.id;
        for (const world::WordCount& w : topic.words) {
          if ((others[k][w.word] -= w.count) == 0) others[k].erase(w.word);
        }
      }
      // A topic that has words of its own may have been matched elsewhere than where it was adopted.
      std::map<world::TopicId, size_t> holder;
      for (const auto& [id, k] : place[i]) holder.emplace(id, static_cast<size_t>(k));
      std::vector<topics::AdoptedTopic> adopted;
      for (size_t k = 0; k < own.size(); ++k) {
        if (own[k] && holder.contains(*own[k]) && holder.at(*own[k]) != k) own[k].reset();
        std::vector<world::WordCount> words;
        for (const auto& [word, count] : others[k]) words.push_back({word, static_cast<int32_t>(count)});
        adopted.push_back({own[k], std::move(words)});
      }
      const std::vector<world::TopicId> ids = robots_[i].adopt(adopted);
      ids_[i].clear();
      for (size_t k = 0; k < ids.size(); ++k) {
        if (number(ids[k]) >= 0 && !adopted[k].words.empty()) ids_[i].emplace(k, ids[k]);
      }
    }
  }

  std::vector<mapping::BelievedTopic> model() const {
    std::vector<mapping::BelievedTopic> topics;
    for (size_t k = 0; k < merged_.size(); ++k) {
      if (merged_[k].empty()) continue;
      mapping::BelievedTopic& topic = topics.emplace_back();
      topic.id = world::TopicId{static_cast<int32_t>(k)};
      for (const auto& [word, count] : merged_[k]) {
        topic.words.push_back({word, static_cast<int32_t>(count)});
        topic.weight += count;
      }
    }
    return topics;
  }

 private:
  std::vector<robot::Explorer> robots_;
  std::vector<Counts> merged_;
  std::vector<std::map<size_t, world::TopicId>> ids_;  // per robot: merged topic -> its id there
};

}  // namespace

MergedTeam learnByMerging(const TeamWords& words, const LearningOptions& options, int32_t exchange_every) {
  if (exchange_every < 1) throw std::invalid_argument("models must be exchanged every 1 or more images");
  Team team(words, options);
  MergedTeam result;
  size_t most = 0;
  for (const auto& images : words.robots) most = std::max(most, images.size());
  const auto every = static_cast<size_t>(exchange_every);
  std::vector<mapping::LocalBelief> beliefs;
  std::vector<std::map<world::TopicId, int>> place;
  for (size_t first = 0; first < most; first += every) {
    for (size_t i = 0; i < words.robots.size(); ++i) {
      const auto& images = words.robots[i];
      for (size_t n = first; n < std::min(images.size(), first + every); ++n) team.robot(i).learn(images[n]);
    }
    beliefs = team.beliefs();
    place = team.merge(beliefs);
    for (const mapping::LocalBelief& belief : beliefs) {
      result.sent +=
          static_cast<double>(bytesOf(belief.topics, belief.groups)) / static_cast<double>(beliefs.size());
    }
    result.received += static_cast<double>(bytesOf(team.model(), beliefs[0].groups));
    team.distribute(beliefs, place);
  }
  const TeamTally counted = tally(beliefs, words.truthOfCell(), FusionRule::kNewestWins);
  std::vector<int> labels;
  for (const TopicTally& topic : counted.topics) {
    labels.push_back(place[static_cast<size_t>(number(topic.robot))].at(topic.topic));
  }
  result.score = score(counted, labels);
  return result;
}

}  // namespace shoal::eval
