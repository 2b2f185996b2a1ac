// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/why_answer.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "shoal/mapping/area_answer.h"
#include "shoal/mapping/edit_question.h"
#include "shoal/mapping/judgement.h"
#include "shoal/mapping/stacked_topics.h"
#include "shoal/mapping/topic_similarities.h"
#include "shoal/rounded.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kNearestTold = 3;
constexpr size_t kWordsTold = 5;

// A topic as another one sees it. Indices are those of StackedTopics::topics.
struct Alike {
  size_t topic = 0;
  double similarity = 0;
};

// The label under question among all topics.
struct Case {
  const StackedTopics& stacked;
  std::vector<world::GlobalLabel> label;  // of every topic
  world::GlobalLabel asked{};
  VertexSimilarity similarity;
  bool own_pairs = false;  // may topics of one robot be joined?

  bool isMember(size_t i) const { return label[i] == asked; }
  bool isMatched(size_t i) const { return stacked.vertex[i] >= 0; }
  bool mayMeet(size_t i, size_t j) const {
    return i != j && isMatched(i) && isMatched(j) &&
           (own_pairs || stacked.topics[i].robot != stacked.topics[j].robot);
  }
  double between(size_t i, size_t j) const { return similarity(stacked.vertex[i], stacked.vertex[j]); }
  std::vector<size_t> members() const {
    std::vector<size_t> all;
    for (size_t i = 0; i < label.size(); ++i)
      if (isMember(i)) all.push_back(i);
    return all;
  }
};

Json alikeJson(const Case& c, const Alike& a) {
  const HeardTopic& topic = c.stacked.topics[a.topic];
  return {{"robot", name(topic.robot)},
          {"topic", number(topic.id)},
          {"label", number(c.label[a.topic])},
          {"similarity", rounded(a.similarity, 1e6)}};
}

Json memberJson(const Case& c, size_t i) {
  std::vector<Alike> fellows;
  std::optional<Alike> outsider;
  double sum = 0;
  for (size_t j = 0; j < c.label.size(); ++j) {
    if (c.isMember(j) ? i == j || !c.isMatched(i) || !c.isMatched(j) : !c.mayMeet(i, j)) continue;
    const Alike alike{j, c.between(i, j)};
    if (c.isMember(j)) {
      sum += alike.similarity;
      fellows.push_back(alike);
    } else if (!outsider || alike.similarity > outsider->similarity) {
      outsider = alike;
    }
  }
  const auto count = static_cast<double>(fellows.size());
  std::ranges::stable_sort(fellows, std::greater<>(), &Alike::similarity);
  if (fellows.size() > kNearestTold) fellows.resize(kNearestTold);
  Json nearest = Json::array();
  for (const Alike& a : fellows) nearest.push_back(alikeJson(c, a));
  const HeardTopic& topic = c.stacked.topics[i];
  return {{"robot", name(topic.robot)},
          {"topic", number(topic.id)},
          {"cells", topic.cells},
          {"weight", topic.weight},
          {"created_s", rounded(topic.created.seconds(), 1e3)},
          {"nearest", std::move(nearest)},
          {"mean_similarity", fellows.empty() ? Json() : Json(rounded(sum / count, 1e6))},
          {"outsider", outsider ? alikeJson(c, *outsider) : Json()}};
}

// How many pairs inside the label, and from it to others, reach sigma; and the pair nearest to sigma.
void addEdges(Json& answer, const Case& c, double sigma) {
  int64_t inside = 0, inside_reach = 0, across = 0, across_reach = 0;
  std::optional<double> nearest;
  std::pair<size_t, Alike> closest;
  for (const size_t i : c.members()) {
    for (size_t j = 0; j < c.label.size(); ++j) {
      if (!c.mayMeet(i, j) || (c.isMember(j) && j < i)) continue;
      const double similarity = c.between(i, j);
      const bool reaches = matching::reaches(similarity, sigma);
      (c.isMember(j) ? inside : across) += 1;
      (c.isMember(j) ? inside_reach : across_reach) += reaches ? 1 : 0;
      if (nearest && std::abs(similarity - sigma) >= *nearest) continue;
      nearest = std::abs(similarity - sigma);
      closest = {i, {j, similarity}};
    }
  }
  answer["pairs"] = {{"inside", inside},
                     {"inside_reaching_sigma", inside_reach},
                     {"across", across},
                     {"across_reaching_sigma", across_reach}};
  answer["margin"] = nearest ? Json(rounded(*nearest, 1e6)) : Json();
  answer["closest"] = Json();
  if (!nearest) return;
  const HeardTopic& member = c.stacked.topics[closest.first];
  answer["closest"] = {
      {"robot", name(member.robot)}, {"topic", number(member.id)}, {"with", alikeJson(c, closest.second)}};
}

// The other label whose topics are most like this one's, in the mean over all pairs.
Json nearestLabel(const Case& c) {
  std::map<world::GlobalLabel, std::pair<double, int64_t>> others;  // sum, pairs
  for (const size_t i : c.members()) {
    for (size_t j = 0; j < c.label.size(); ++j) {
      if (c.isMember(j) || !c.isMatched(i) || !c.isMatched(j)) continue;
      auto& [sum, pairs] = others[c.label[j]];
      sum += c.between(i, j);
      ++pairs;
    }
  }
  std::optional<std::pair<double, world::GlobalLabel>> best;
  for (const auto& [label, total] : others) {
    const double mean = total.first / static_cast<double>(total.second);
    if (!best || mean > best->first) best = {mean, label};
  }
  if (!best) return {};
  return {{"label", number(best->second)}, {"mean_similarity", rounded(best->first, 1e6)}};
}

// The words that the members share, by group: heaviest in the mean.
Json sharedWords(const Case& c) {
  struct Word {
    int32_t word = 0;
    double share = 0;  // summed over the members
    int64_t members = 0;
  };
  const auto& first = c.stacked.descriptors.group_first;
  std::vector<size_t> members = c.members();
  std::erase_if(members, [&c](size_t i) { return !c.isMatched(i); });
  Json groups = Json::array();
  for (size_t g = 0; g < first.size() && !members.empty(); ++g) {
    const int32_t begin = first[g];
    const int32_t end = g + 1 < first.size() ? first[g + 1] : c.stacked.descriptors.vocabulary_size;
    std::map<int32_t, Word> words;
    for (const size_t i : members) {
      const auto& counts = c.stacked.topics[i].words;
      int64_t total = 0;
      for (const auto& [word, count] : counts) total += word >= begin && word < end ? count : 0;
      for (const auto& [word, count] : counts) {
        if (word < begin || word >= end) continue;
        Word& w = words[word];
        w.word = word;
        w.share += static_cast<double>(count) / static_cast<double>(total);
        ++w.members;
      }
    }
    std::vector<Word> heaviest;
    for (const auto& [word, w] : words)
      if (w.members > 1 || members.size() == 1) heaviest.push_back(w);
    std::ranges::stable_sort(heaviest, std::greater<>(), &Word::share);
    if (heaviest.size() > kWordsTold) heaviest.resize(kWordsTold);
    Json told = Json::array();
    for (const Word& w : heaviest) {
      told.push_back({{"word", w.word},
                      {"share", rounded(w.share / static_cast<double>(members.size()), 1e4)},
                      {"members", w.members}});
    }
    groups.push_back({{"first", begin}, {"size", end - begin}, {"words", std::move(told)}});
  }
  return groups;
}

}  // namespace

Json whyAnswer(const MissionView& view, const BeliefStore& beliefs, const matching::MatcherOptions& options,
               const std::string& label) {
  const auto asked = labelNamed(view.map, label);
  if (!asked) return {{"error", noSuchLabel(view.map, label)}};
  const LabelSummary& row = *std::ranges::find(view.map.labels, *asked, &LabelSummary::label);

  const std::vector<Edit> edits = editsOf(beliefs);
  std::vector<Standing> standings;
  const Judgement judgement = judge(edits, beliefs, &standings);
  const StackedTopics stacked = stack(beliefs, judgement.excluded);
  Case c{.stacked = stacked,
         .label = {},
         .asked = *asked,
         .similarity = similarityOf(stacked, options),
         .own_pairs = !options.keepsOwnApart()};
  std::map<std::pair<world::RobotId, world::TopicId>, world::GlobalLabel> label_of;
  for (const Correspondence& k : view.map.correspondences) label_of[{k.robot, k.topic}] = k.label;
  for (const HeardTopic& topic : stacked.topics) {
    const auto known = label_of.find({topic.robot, topic.id});
    c.label.push_back(known == label_of.end() ? world::globalLabel(topic.robot, topic.id) : known->second);
  }

  Json members = Json::array();
  for (const size_t i : c.members()) members.push_back(memberJson(c, i));
  Json answer = {{"label", number(row.label)},
                 {"name", row.name},
                 {"cells", row.cells},
                 {"matcher", options.matcher},
                 {"similarity", options.similarity},
                 {"sigma", matching::usesSigma(options.matcher) ? Json(options.leastSimilarity()) : Json()},
                 {"members", std::move(members)},
                 {"nearest_label", nearestLabel(c)},
                 {"pairs", Json()},
                 {"margin", Json()},
                 {"closest", Json()},
                 {"shared_words", sharedWords(c)},
                 {"decided", Json::array()}};
  for (size_t e = 0; e < edits.size(); ++e) {
    const auto* link = std::get_if<LinkEdit>(&edits[e].operation);
    if (link == nullptr || standings[e] != Standing::kInForce) continue;
    const bool concerns = std::ranges::any_of(c.members(), [&](size_t i) {
      const Topic member{stacked.topics[i].robot, stacked.topics[i].id};
      return member == Topic{link->a.robot, link->a.topic} || member == Topic{link->b.robot, link->b.topic};
    });
    if (concerns) answer["decided"].push_back(toText(edits[e].id) + ": " + sentenceOf(edits[e]));
  }
  const double sigma = options.leastSimilarity();
  if (options.matcher == "clear") addEdges(answer, c, sigma);
  const Json& nearest = answer["nearest_label"];
  if (options.matcher == "shoal" && !nearest.is_null())
    answer["margin"] = rounded(sigma - nearest["mean_similarity"].get<double>(), 1e6);
  return answer;
}

}  // namespace shoal::mapping
