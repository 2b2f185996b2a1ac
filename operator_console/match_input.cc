// SPDX-License-Identifier: BSD-3-Clause
#include "match_input.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <istream>
#include <limits>
#include <nlohmann/json.hpp>
#include <set>
#include <stdexcept>
#include <utility>

namespace shoal::console {
namespace {

constexpr int kMaxDepth = 16;
constexpr int64_t kMaxLabelsOfARobot = 10'000;  // topic ids are below this
constexpr int64_t kMaxRobots = 100'000;
constexpr int64_t kMaxLabels = 200'000;

[[noreturn]] void fail(const std::string& what) { throw std::invalid_argument(what); }

std::string shown(const nlohmann::json& value) {
  std::string text = value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  return text.size() <= 40 ? text : text.substr(0, 37) + "...";
}

std::string element(const std::string& place, size_t i) { return place + "[" + std::to_string(i) + "]"; }

const nlohmann::json& array(const nlohmann::json& value, const std::string& place) {
  if (!value.is_array()) fail(place + " must be a list, got " + shown(value));
  return value;
}

int64_t whole(const nlohmann::json& value, const std::string& place, int64_t least, int64_t most) {
  const bool fits = value.is_number_unsigned() ? value.get<uint64_t>() <= static_cast<uint64_t>(most)
                                               : value.is_number_integer() && value.get<int64_t>() <= most;
  if (!fits || value.get<int64_t>() < least) {
    fail(place + " must be a whole number in [" + std::to_string(least) + ", " + std::to_string(most) +
         "], got " + shown(value));
  }
  return value.get<int64_t>();
}

const nlohmann::json& member(const nlohmann::json& object, const char* key, const std::string& place) {
  if (!object.is_object()) fail(place + " must be an object, got " + shown(object));
  const auto found = object.find(key);
  if (found == object.end()) fail(place + " lacks \"" + key + "\"");
  return *found;
}

std::string readAll(std::istream& in, size_t max_bytes) {
  std::string text;
  std::vector<char> chunk(size_t{1} << 16);
  while (in.read(chunk.data(), static_cast<std::streamsize>(chunk.size())), in.gcount() > 0) {
    text.append(chunk.data(), static_cast<size_t>(in.gcount()));
    if (text.size() > max_bytes) fail("the input is longer than " + std::to_string(max_bytes) + " bytes");
  }
  return text;
}

nlohmann::json parse(const std::string& text) {
  std::vector<std::set<std::string>> keys;  // of the objects that are open
  const auto watch = [&keys](int depth, nlohmann::json::parse_event_t event, nlohmann::json& value) {
    if (depth > kMaxDepth) fail("the input is nested deeper than " + std::to_string(kMaxDepth) + " levels");
    if (event == nlohmann::json::parse_event_t::object_start) keys.emplace_back();
    if (event == nlohmann::json::parse_event_t::object_end) keys.pop_back();
    if (event == nlohmann::json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second) {
      fail("key " + shown(value) + " is there twice in one object");
    }
    return true;
  };
  try {
    return nlohmann::json::parse(text, watch);
  } catch (const nlohmann::json::exception& e) {
    std::string what = e.what();
    std::replace(what.begin(), what.end(), '\n', ' ');
    fail("not valid JSON: " + what);
  }
}

// Counts robots and labels as they come, so that a small file cannot ask for much memory.
class Limits {
 public:
  void add(int64_t num_labels, const std::string& place) {
    num_labels_ += num_labels;
    if (++num_robots_ > kMaxRobots || num_labels_ > kMaxLabels) {
      fail(place + ": more than " + std::to_string(kMaxRobots) + " robots or " + std::to_string(kMaxLabels) +
           " labels in all");
    }
  }

 private:
  int64_t num_robots_ = 0;
  int64_t num_labels_ = 0;
};

matching::AssociationGraph readGraph(const nlohmann::json& root, MatchInput& input) {
  matching::AssociationGraph graph;
  const nlohmann::json& counts = array(member(root, "counts", "the input"), "counts");
  Limits limits;
  for (size_t r = 0; r < counts.size(); ++r) {
    const std::string place = element("counts", r);
    const int64_t count = whole(counts[r], place, 0, kMaxLabelsOfARobot);
    limits.add(count, place);
    input.names.push_back("robot " + std::to_string(r));
    input.num_labels.push_back(static_cast<int>(count));
  }
  graph.num_topics = input.num_labels;
  const std::vector<int> owner = matching::owners(graph);
  const auto last = static_cast<int64_t>(owner.size()) - 1;

  const nlohmann::json& edges = array(root.at("edges"), "edges");
  std::vector<std::pair<std::pair<int, int>, size_t>> pairs;
  size_t num_inside = 0;
  std::string first_inside;
  for (size_t e = 0; e < edges.size(); ++e) {
    const std::string place = element("edges", e);
    if (!edges[e].is_array() || edges[e].size() < 2 || edges[e].size() > 3) {
      fail(place + " must be [i, j] or [i, j, weight], got " + shown(edges[e]));
    }
    if (last < 0) fail(place + " joins labels, but there are none");
    const auto a = static_cast<int>(whole(edges[e][0], place + "[0]", 0, last));
    const auto b = static_cast<int>(whole(edges[e][1], place + "[1]", 0, last));
    matching::Edge edge{std::min(a, b), std::max(a, b)};
    if (edges[e].size() == 3) {
      const nlohmann::json& weight = edges[e][2];
      edge.weight = weight.is_number() ? weight.get<double>() : -1.0;
      if (!(edge.weight >= 0.0) || !std::isfinite(edge.weight)) {
        fail(place + "[2] must be a finite weight >= 0, got " + shown(weight));
      }
    }
    pairs.push_back({{edge.i, edge.j}, e});
    if (owner[static_cast<size_t>(a)] == owner[static_cast<size_t>(b)]) {
      if (num_inside++ == 0) first_inside = place + " = " + shown(edges[e]);
    } else {
      graph.edges.push_back(edge);
    }
  }
  std::sort(pairs.begin(), pairs.end());
  for (size_t p = 1; p < pairs.size(); ++p) {
    if (pairs[p].first == pairs[p - 1].first) {
      fail(element("edges", pairs[p].second) + " repeats " + element("edges", pairs[p - 1].second) +
           ": an edge stands for both directions");
    }
  }
  if (num_inside > 0) {
    input.warnings.push_back(std::to_string(num_inside) + " edge(s) inside a robot ignored, the first is " +
                             first_inside);
  }
  return graph;
}

std::vector<int32_t> readGroups(const nlohmann::json& groups, int64_t vocabulary) {
  std::vector<int32_t> first;
  int64_t next = 0;
  array(groups, "groups");
  for (size_t g = 0; g < groups.size(); ++g) {
    const std::string place = element("groups", g);
    if (!member(groups[g], "name", place).is_string()) fail(place + ".name must be a string");
    first.push_back(
        static_cast<int32_t>(whole(member(groups[g], "first", place), place + ".first", next, next)));
    next += whole(member(groups[g], "size", place), place + ".size", 1, vocabulary - next);
  }
  if (!first.empty() && next != vocabulary) {
    fail("groups hold " + std::to_string(next) + " words, but the vocabulary " + std::to_string(vocabulary));
  }
  return first;
}

matching::Descriptor readTopic(const nlohmann::json& topic, const std::string& place, int64_t vocabulary,
                               int32_t slot) {
  matching::Descriptor descriptor;
  const nlohmann::json& words = member(topic, "words", place);
  if (!words.is_object()) fail(place + ".words must be an object, got " + shown(words));
  descriptor.slot = slot;
  if (topic.contains("id")) {
    descriptor.slot = static_cast<int32_t>(whole(topic["id"], place + ".id", 0, kMaxLabelsOfARobot - 1));
  }
  for (const auto& [key, value] : words.items()) {
    int32_t word = -1;
    const auto [end, error] = std::from_chars(key.data(), key.data() + key.size(), word);
    if (error != std::errc() || end != key.data() + key.size() || word < 0 || word >= vocabulary) {
      fail(place + ".words: " + shown(key) + " is no word of the vocabulary of " +
           std::to_string(vocabulary));
    }
    const int64_t count = whole(value, place + ".words." + key, 0, int64_t{1} << 40);
    if (count > 0) descriptor.entries.push_back({word, count});
  }
  const auto by_word = [](const auto& a, const auto& b) { return a.word < b.word; };
  std::sort(descriptor.entries.begin(), descriptor.entries.end(), by_word);
  return descriptor;
}

std::optional<std::string> readName(const nlohmann::json& root, const char* key) {
  if (!root.contains(key)) return std::nullopt;
  if (!root[key].is_string()) fail(std::string(key) + " must be a string, got " + shown(root[key]));
  return root[key].get<std::string>();
}

matching::DescriptorSet readDescriptors(const nlohmann::json& root, MatchInput& input) {
  matching::DescriptorSet set;
  const int64_t vocabulary =
      whole(member(root, "vocabulary", "the input"), "vocabulary", 0, std::numeric_limits<int32_t>::max());
  set.vocabulary_size = static_cast<int32_t>(vocabulary);
  if (root.contains("groups")) set.group_first = readGroups(root["groups"], vocabulary);
  const nlohmann::json& robots = array(root.at("robots"), "robots");
  Limits limits;
  std::set<std::string> names;
  for (size_t r = 0; r < robots.size(); ++r) {
    const std::string place = element("robots", r);
    const nlohmann::json& topics = array(member(robots[r], "topics", place), place + ".topics");
    const std::string name = readName(robots[r], "name").value_or("robot " + std::to_string(r));
    if (!names.insert(name).second) {
      fail(place + ": a robot named \"" + name + "\" is there already");
    }
    if (topics.size() > static_cast<size_t>(kMaxLabelsOfARobot)) {
      fail(place + ".topics has more than " + std::to_string(kMaxLabelsOfARobot) + " topics");
    }
    limits.add(static_cast<int64_t>(topics.size()), place);
    input.names.push_back(name);
    input.num_labels.push_back(static_cast<int>(topics.size()));
    std::vector<matching::Descriptor>& robot = set.robots.emplace_back();
    for (size_t t = 0; t < topics.size(); ++t) {
      const std::string topic = element(place + ".topics", t);
      robot.push_back(readTopic(topics[t], topic, vocabulary, static_cast<int32_t>(t)));
    }
  }
  matching::check(set);
  input.matcher = readName(root, "matcher");
  input.similarity = readName(root, "similarity");
  if (root.contains("sigma")) {
    const nlohmann::json& sigma = root["sigma"];
    if (!sigma.is_number() && sigma != "auto")
      fail("sigma must be \"auto\" or a number in (0, 1], got " + shown(sigma));
    if (sigma.is_number()) input.sigma = sigma.get<double>();
  }
  return set;
}

}  // namespace

MatchInput readMatchInput(std::istream& in, size_t max_bytes) {
  const nlohmann::json root = parse(readAll(in, max_bytes));
  if (!root.is_object()) fail("the input must be an object, got " + shown(root));
  MatchInput input;
  if (root.contains("edges")) {
    input.labels = readGraph(root, input);
  } else if (root.contains("robots")) {
    input.labels = readDescriptors(root, input);
  } else {
    fail("the input must have \"counts\" and \"edges\", or \"vocabulary\" and \"robots\"");
  }
  return input;
}

}  // namespace shoal::console
