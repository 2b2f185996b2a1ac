// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/known_topics_file.h"

#include <stdexcept>
#include <utility>
#include <variant>

#include "shoal/mapping/belief_files.h"
#include "shoal/robot/profile.h"
#include "shoal/vision/word_extractor.h"

namespace shoal::robot {
namespace {

std::string textOf(const std::vector<world::WordGroup>& groups) {
  std::string text;
  for (const world::WordGroup& g : groups)
    text += (text.empty() ? "" : ", ") + g.name + " " + std::to_string(g.size);
  return text.empty() ? "none" : text;
}

int32_t mostTopics(const std::string& profile) {
  return std::visit([](const auto& h) { return h.max_topics; }, hyperparametersOf(profile));
}

}  // namespace

std::vector<topics::KnownTopic> readKnownTopics(const std::string& path, const std::string& profile) {
  const auto words = vision::makeWordExtractor(profile);
  mapping::LocalBelief belief = mapping::readTopics(path);
  const std::string made_with = textOf(belief.groups), has = textOf(words->groups());
  if (made_with != has)
    throw std::runtime_error(path + ": learnt with other words (" + made_with + ") than profile " + profile +
                             " has (" + has + ")");
  std::vector<topics::KnownTopic> known;
  for (mapping::BelievedTopic& topic : belief.topics) known.push_back({topic.id, std::move(topic.words)});
  try {
    topics::check(known, words->vocabularySize(), mostTopics(profile));
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
  return known;
}

}  // namespace shoal::robot
