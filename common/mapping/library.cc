// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/library.h"

#include <algorithm>

#include "shoal/mapping/judgement.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/stacked_topics.h"
#include "shoal/random.h"

namespace shoal::mapping {
namespace {

const std::string kAuthor = "LIBRARY";
constexpr int32_t kMostOfAWord = 1 << 30;
// Later than anything that a robot has seen: no label is named after a topic of the library.
constexpr int64_t kNeverUs = (int64_t{1} << 62) - 1;

// All that is known under one name.
struct Gathered {
  int64_t weight = 0;
  std::map<int32_t, int64_t> words;
};

void add(Gathered& to, int64_t weight, const std::vector<world::WordCount>& words) {
  to.weight += weight;
  for (const auto& [word, count] : words) to.words[word] += count;
}

LibraryTopic topicOf(const std::string& name, const Gathered& gathered) {
  LibraryTopic topic{name, gathered.weight, {}};
  for (const auto& [word, count] : gathered.words) {
    topic.words.push_back({word, static_cast<int32_t>(std::min<int64_t>(count, kMostOfAWord))});
  }
  topic.words = quantize(topic.words);
  return topic;
}

}  // namespace

uint64_t digestOf(const Library& library) {
  uint64_t hash = hashCombine(library.group_sizes.size(), library.topics.size());
  for (const int32_t size : library.group_sizes) hash = hashCombine(hash, static_cast<uint64_t>(size));
  for (const LibraryTopic& topic : library.topics) {
    hash = hashCombine(hash, topic.name.size());
    for (const char c : topic.name) hash = hashCombine(hash, static_cast<uint8_t>(c));
    hash = hashCombine(hashCombine(hash, static_cast<uint64_t>(topic.weight)), topic.words.size());
    for (const auto& [word, count] : topic.words) {
      hash = hashCombine(hashCombine(hash, static_cast<uint64_t>(word)), static_cast<uint64_t>(count));
    }
  }
  return hash;
}

int32_t epochOf(const Library& library) { return static_cast<int32_t>(digestOf(library) >> 33); }

std::vector<Piece> piecesOf(const Library& library) {
  std::vector<Piece> pieces;
  const int32_t epoch = epochOf(library);
  int32_t id = 0;
  for (const LibraryTopic& topic : library.topics) {
    pieces.push_back({.key = {kLibrary, PieceKind::kTopic, {id, 0, 0}},
                      .version = {epoch, 0},
                      .content = TopicPart{{kNeverUs}, topic.weight, library.group_sizes, topic.words}});
    pieces.push_back(pieceOf(Edit{.id = {kAuthor, id + 1},
                                  .time = {0},
                                  .operation = NameEdit{{kLibrary, epoch, world::TopicId{id}}, topic.name}}));
    ++id;
  }
  return pieces;
}

namespace {

// What the library in force called its topics, whatever operators said of them since.
std::map<world::TopicId, std::string> namesTold(const BeliefStore& beliefs) {
  std::map<world::TopicId, std::string> told;
  for (const Edit& edit : editsOf(beliefs)) {
    const auto* name = std::get_if<NameEdit>(&edit.operation);
    if (name == nullptr || edit.id.author != kAuthor || name->topic.robot != kLibrary) continue;
    if (name->topic.epoch == beliefs.epochOf(kLibrary)) told.emplace(name->topic.topic, name->text);
  }
  return told;
}

}  // namespace

Library libraryIn(const BeliefStore& beliefs) {
  const auto names = namesTold(beliefs);
  Library library;
  std::map<world::TopicId, LibraryTopic> topics;
  beliefs.visitOf(kLibrary, [&](const Piece& piece) {
    const auto* part = std::get_if<TopicPart>(&piece.content);
    const world::TopicId id{piece.key.index[0]};
    if (part == nullptr || !names.contains(id)) return;
    library.group_sizes = part->group_sizes;
    LibraryTopic& topic = topics[id];
    topic.name = names.at(id);
    topic.weight = part->weight;
    topic.words.insert(topic.words.end(), part->words.begin(), part->words.end());
  });
  for (auto& [id, topic] : topics) {
    std::ranges::sort(topic.words);
    library.topics.push_back(std::move(topic));
  }
  return library;
}

Library libraryOf(const GlobalMap& map, const BeliefStore& beliefs) {
  std::map<world::GlobalLabel, std::string> name_of;
  for (const LabelSummary& row : map.labels)
    if (!row.name.empty()) name_of.emplace(row.label, row.name);
  std::map<Topic, world::GlobalLabel> label_of;
  for (const Correspondence& c : map.correspondences) label_of.emplace(Topic{c.robot, c.topic}, c.label);

  const Judgement judgement = judge(beliefs);
  const StackedTopics stacked = stack(beliefs, judgement.excluded);
  Library library;
  std::map<std::string, Gathered> gathered;
  for (size_t i = 0; i < stacked.topics.size(); ++i) {
    const HeardTopic& topic = stacked.topics[i];
    if (stacked.vertex[i] < 0 || topic.words.empty()) continue;
    library.group_sizes = topic.group_sizes;
    const auto label = label_of.find({topic.robot, topic.id});
    const auto named = label == label_of.end() ? name_of.end() : name_of.find(label->second);
    if (named != name_of.end()) {
      add(gathered[named->second], topic.weight, topic.words);
    } else if (topic.robot == kLibrary) {
      const auto own = judgement.names.find({topic.robot, topic.id});
      if (own != judgement.names.end() && !own->second.text.empty())
        add(gathered[own->second.text], topic.weight, topic.words);
    }
  }
  for (const auto& [name, all] : gathered) {
    if (library.topics.size() == kMaxLibraryTopics) break;
    library.topics.push_back(topicOf(name, all));
  }
  return library;
}

std::map<world::GlobalLabel, std::vector<std::string>> libraryNames(const GlobalMap& map,
                                                                    const BeliefStore& beliefs) {
  std::map<world::GlobalLabel, std::vector<std::string>> names;
  const auto told = namesTold(beliefs);
  for (const Correspondence& c : map.correspondences) {
    const auto name = told.find(c.topic);
    if (c.robot == kLibrary && name != told.end()) names[c.label].push_back(name->second);
  }
  for (auto& [label, list] : names) std::ranges::sort(list);
  return names;
}

}  // namespace shoal::mapping
