// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/known_topics.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <string>

#include "shoal/demand.h"
#include "shoal/random.h"

namespace shoal::topics {

void check(const std::vector<KnownTopic>& known, int32_t vocabulary_size, int32_t max_topics) {
  const auto refuse = [](const std::string& why) { throw std::invalid_argument("known topics: " + why); };
  if (std::ssize(known) > max_topics) {
    refuse(std::to_string(known.size()) + " of them, and at most " + std::to_string(max_topics) +
           " may be in use");
  }
  std::set<world::TopicId> ids;
  int64_t left = int64_t{1} << 30;
  for (const KnownTopic& topic : known) {
    const std::string name = "topic " + std::to_string(number(topic.id));
    if (number(topic.id) < 0 || number(topic.id) > world::kMaxTopicId)
      refuse(name + ": ids lie in [0, 9999]");
    if (!ids.insert(topic.id).second) refuse(name + " is there twice");
    if (topic.words.empty()) refuse(name + " has no words");
    int32_t before = -1;
    for (const world::WordCount& w : topic.words) {
      if (w.word <= before || w.word >= vocabulary_size || w.count <= 0)
        refuse(name + ": words are out of order or range, at word " + std::to_string(w.word));
      before = w.word;
      left -= w.count;
      if (left < 0) refuse("more than 2^30 words");
    }
  }
}

std::vector<TopicSlots::Named> namesOf(const std::vector<KnownTopic>& known) {
  std::vector<TopicSlots::Named> names;
  for (const KnownTopic& topic : known) names.push_back({static_cast<int32_t>(names.size()), topic.id, {}});
  return names;
}

int32_t numIdsOf(const std::vector<KnownTopic>& known) {
  int32_t ids = 0;
  for (const KnownTopic& topic : known) ids = std::max(ids, number(topic.id) + 1);
  return ids;
}

uint64_t hashOf(const std::vector<KnownTopic>& known) {
  uint64_t hash = 0;
  for (const KnownTopic& topic : known) {
    hash = hashCombine(hashCombine(hash, static_cast<uint64_t>(number(topic.id))), topic.words.size());
    for (const world::WordCount& w : topic.words) {
      hash = hashCombine(hashCombine(hash, static_cast<uint64_t>(w.word)), static_cast<uint64_t>(w.count));
    }
  }
  return hash;
}

void subtract(std::vector<world::WordCount>& words, std::span<const world::WordCount> less) {
  auto word = words.begin();
  for (const world::WordCount& taken : less) {
    word = std::lower_bound(word, words.end(), taken.word,
                            [](const world::WordCount& w, int32_t id) { return w.word < id; });
    SHOAL_DEMAND(word != words.end() && word->word == taken.word && word->count >= taken.count);
    word->count -= taken.count;
  }
  std::erase_if(words, [](const world::WordCount& w) { return w.count == 0; });
}

}  // namespace shoal::topics
