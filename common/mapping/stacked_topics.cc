// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/stacked_topics.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "shoal/mapping/common_settings.h"
#include "shoal/mapping/library.h"

namespace shoal::mapping {
namespace {

using TopicKey = std::pair<world::RobotId, world::TopicId>;

// The layout of word groups that most comparable robots use; the first robot's among equals.
std::vector<int32_t> commonLayout(const std::vector<HeardTopic>& topics,
                                  const std::set<world::RobotId>& comparable) {
  std::vector<std::pair<std::vector<int32_t>, std::set<world::RobotId>>> users;
  for (const HeardTopic& topic : topics) {
    if (topic.robot == kLibrary || !comparable.contains(topic.robot)) continue;
    auto known = std::ranges::find(users, topic.group_sizes, [](const auto& u) { return u.first; });
    if (known == users.end()) known = users.insert(users.end(), {topic.group_sizes, {}});
    known->second.insert(topic.robot);
  }
  const auto most = std::ranges::max_element(users, {}, [](const auto& u) { return u.second.size(); });
  return most == users.end() ? std::vector<int32_t>{} : most->first;
}

}  // namespace

StackedTopics stack(const BeliefStore& beliefs, const std::set<world::RobotId>& excluded) {
  std::map<TopicKey, int64_t> cells;
  beliefs.visit([&](const Piece& piece) {
    const auto* brick = std::get_if<BrickPart>(&piece.content);
    if (brick == nullptr) return;
    for (const BrickCell& c : brick->cells) ++cells[{piece.key.robot, c.topic}];
  });
  return stack(beliefs, excluded, cells);
}

StackedTopics stack(const BeliefStore& beliefs, const std::set<world::RobotId>& excluded,
                    const std::map<TopicKey, int64_t>& cells) {
  std::map<TopicKey, HeardTopic> heard;
  beliefs.visitTopics([&](const Piece& piece) {
    const auto* part = std::get_if<TopicPart>(&piece.content);
    if (part == nullptr || part->weight <= 0 || excluded.contains(piece.key.robot)) return;
    const world::TopicId id{piece.key.index[0]};
    const auto [known, is_first] = heard.try_emplace(
        {piece.key.robot, id},
        HeardTopic{piece.key.robot, id, part->created, part->weight, 0, part->group_sizes, {}});
    HeardTopic& topic = known->second;
    if (!is_first && topic.group_sizes != part->group_sizes) return;  // part 0 decides
    topic.words.insert(topic.words.end(), part->words.begin(), part->words.end());
  });

  StackedTopics stacked;
  for (auto& [key, topic] : heard) {
    // Honest parts share no word. Of others the first count stands.
    if (!std::ranges::is_sorted(topic.words)) std::ranges::sort(topic.words);
    const auto same = [](const world::WordCount& a, const world::WordCount& b) { return a.word == b.word; };
    topic.words.erase(std::unique(topic.words.begin(), topic.words.end(), same), topic.words.end());
    topic.cells = cells.contains(key) ? cells.at(key) : 0;
    stacked.topics.push_back(std::move(topic));
  }
  std::set<world::RobotId> comparable;
  const auto common = commonSettings(beliefs, excluded);
  for (const world::RobotId robot : beliefs.robots())
    if (compare(beliefs, robot, common) == Comparable::kSame) comparable.insert(robot);
  const std::vector<int32_t> layout = commonLayout(stacked.topics, comparable);
  matching::DescriptorSet& set = stacked.descriptors;
  set.vocabulary_size = std::reduce(layout.begin(), layout.end());
  for (int32_t first = 0; const int32_t size : layout) {
    set.group_first.push_back(first);
    first += size;
  }
  const world::RobotId* last = nullptr;
  int32_t next_vertex = 0;
  for (const HeardTopic& topic : stacked.topics) {
    const bool is_comparable =
        topic.robot == kLibrary || (topic.cells > 0 && comparable.contains(topic.robot));
    const bool takes_part = is_comparable && topic.group_sizes == layout;
    stacked.vertex.push_back(takes_part ? next_vertex++ : -1);
    if (!takes_part) continue;
    if (last == nullptr || *last != topic.robot) set.robots.emplace_back();
    last = &topic.robot;
    matching::Descriptor descriptor{.slot = number(topic.id), .entries = {}};
    for (const auto& [word, count] : topic.words) descriptor.entries.push_back({word, count});
    set.robots.back().push_back(std::move(descriptor));
  }
  return stacked;
}

}  // namespace shoal::mapping
