// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <charconv>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "shoal/mapping/label_name.h"
#include "shoal/mapping/library.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kFormat = 1;
constexpr int32_t kMaxVocabulary = 1 << 20;  // as on the wire
constexpr size_t kMaxGroups = 64;
constexpr int32_t kMaxCount = 1 << 30;

template <typename Integer>
Integer integerIn(const Json& json, int64_t least, int64_t most, const char* what) {
  if (!json.is_number_integer() || json.get<int64_t>() < least || json.get<int64_t>() > most) {
    throw std::invalid_argument(std::string(what) + " is a whole number from " + std::to_string(least) +
                                " to " + std::to_string(most) + ", got " + json.dump());
  }
  return static_cast<Integer>(json.get<int64_t>());
}

LibraryTopic topicFrom(const Json& json, int32_t vocabulary) {
  LibraryTopic topic;
  topic.name = json.at("name").get<std::string>();
  if (topic.name.empty() || !isLabelName(topic.name)) {
    throw std::invalid_argument("a name has 1 to 64 bytes of UTF-8 without control characters");
  }
  topic.weight = integerIn<int64_t>(json.at("weight"), 1, int64_t{1} << 53, "a weight");
  if (!json.at("words").is_object())
    throw std::invalid_argument("\"words\" of a topic are {\"word\": count}");
  for (const auto& [text, count] : json.at("words").items()) {
    int32_t word = -1;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), word);
    if (error != std::errc{} || end != text.data() + text.size() || word < 0 || word >= vocabulary) {
      throw std::invalid_argument("\"" + text + "\" is no word of a vocabulary of " +
                                  std::to_string(vocabulary));
    }
    topic.words.push_back({word, integerIn<int32_t>(count, 1, kMaxCount, "a count")});
  }
  if (topic.words.empty()) throw std::invalid_argument("\"" + topic.name + "\" has no words");
  std::ranges::sort(topic.words);
  for (size_t i = 1; i < topic.words.size(); ++i) {
    if (topic.words[i - 1].word == topic.words[i].word) {
      throw std::invalid_argument("\"" + topic.name + "\" has a word twice");
    }
  }
  return topic;
}

}  // namespace

std::string libraryJson(const Library& library) {
  Json json{{"shoal_library", kFormat}, {"groups", library.group_sizes}, {"topics", Json::array()}};
  for (const LibraryTopic& topic : library.topics) {
    Json words = Json::object();
    for (const auto& [word, count] : topic.words) words[std::to_string(word)] = count;
    json["topics"].push_back({{"name", topic.name}, {"weight", topic.weight}, {"words", std::move(words)}});
  }
  return json.dump(1) + "\n";
}

Library parseLibrary(const std::string& text, const std::string& path) {
  try {
    const Json json = Json::parse(text);
    if (json.at("shoal_library") != kFormat) {
      throw std::invalid_argument("format " + json.at("shoal_library").dump() +
                                  " is not 1, the only one known");
    }
    Library library;
    int32_t vocabulary = 0;
    if (!json.at("groups").is_array() || json.at("groups").size() > kMaxGroups) {
      throw std::invalid_argument("\"groups\" is a list of at most 64 sizes");
    }
    for (const Json& size : json.at("groups")) {
      library.group_sizes.push_back(
          integerIn<int32_t>(size, 1, kMaxVocabulary - vocabulary, "a group's size"));
      vocabulary += library.group_sizes.back();
    }
    if (!json.at("topics").is_array() || json.at("topics").size() > kMaxLibraryTopics) {
      throw std::invalid_argument("\"topics\" is a list of at most 1000");
    }
    for (const Json& topic : json.at("topics")) library.topics.push_back(topicFrom(topic, vocabulary));
    std::ranges::sort(library.topics, {}, &LibraryTopic::name);
    const auto twice = std::ranges::adjacent_find(library.topics, {}, &LibraryTopic::name);
    if (twice != library.topics.end()) throw std::invalid_argument("\"" + twice->name + "\" is there twice");
    return library;
  } catch (const Json::exception& error) {
    throw std::runtime_error(path + " is no library as `library save` writes it: " + error.what());
  } catch (const std::invalid_argument& error) {
    throw std::runtime_error(path + ": " + error.what());
  }
}

}  // namespace shoal::mapping
