// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/experiment.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>
#include <span>

#include "shoal/eval/merging_team.h"
#include "shoal/eval/topic_tally.h"
#include "shoal/random.h"

namespace shoal::eval {
namespace {

constexpr uint64_t kOrderStream = 0x6f72646572;  // "order"

// Beliefs of every robot at every checkpoint: [robot][checkpoint].
using Beliefs = std::vector<std::vector<mapping::LocalBelief>>;

struct Flown {
  Beliefs beliefs;
  std::vector<Landed> landed;  // by robot
};

Flown flyAll(const TeamWords& words, const LearningOptions& learning,
             const std::vector<int32_t>& checkpoints) {
  Flown flown;
  for (size_t i = 0; i < words.robots.size(); ++i) {
    std::vector<uint8_t> mind;
    flown.beliefs.push_back(learn(words.robots[i], world::RobotId{static_cast<int32_t>(i)}, words.cell_size_m,
                                  learning, checkpoints, &mind));
    flown.landed.push_back({flown.beliefs.back().back(), std::move(mind)});
  }
  return flown;
}

// Of a team of these robots that has landed.
std::vector<mapping::LocalBelief> inTheEnd(const Flown& flown, std::span<const size_t> robots,
                                           double cell_size_m, const LearningOptions& learning) {
  std::vector<const Landed*> team;
  for (const size_t robot : robots) team.push_back(&flown.landed[robot]);
  return lookAgain(team, cell_size_m, learning);
}

std::vector<mapping::LocalBelief> pick(const Beliefs& beliefs, std::span<const size_t> robots,
                                       size_t checkpoint) {
  std::vector<mapping::LocalBelief> team;
  for (const size_t robot : robots) team.push_back(beliefs[robot][checkpoint]);
  return team;
}

std::vector<Score> scoreAll(const Stacked& team, const TeamTally& counted,
                            const std::vector<matching::MatcherOptions>& matchers) {
  std::vector<Score> scores;
  for (const matching::MatcherOptions& m : matchers) scores.push_back(scoreMatcher(team, counted, m));
  return scores;
}

Point point(int32_t at, const std::vector<mapping::LocalBelief>& team, const TruthOfCell& truth,
            const std::vector<matching::MatcherOptions>& matchers) {
  const Stacked stacked = stackTeam(team);
  const TeamTally counted = tally(stacked.beliefs, truth, FusionRule::kNewestWins);
  Point result{.at = at, .ami = {}};
  for (const Score& s : scoreAll(stacked, counted, matchers)) result.ami.push_back(s.ami);
  return result;
}

Score scoreAlone(const mapping::LocalBelief& belief, const TruthOfCell& truth) {
  const TeamTally counted = tally(std::span(&belief, 1), truth, FusionRule::kNewestWins);
  std::vector<int> own(counted.topics.size());
  std::iota(own.begin(), own.end(), 0);
  return score(counted, own);
}

std::vector<size_t> shuffled(size_t count, uint64_t seed) {
  std::vector<size_t> order(count);
  std::iota(order.begin(), order.end(), size_t{0});
  Random random(seed, kOrderStream);
  for (size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

}  // namespace

Repeat runRepeat(const TeamWords& words, const RepeatOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  const TruthOfCell truth = words.truthOfCell();
  size_t images = 0;
  for (const auto& robot : words.robots) images = std::max(images, robot.size());
  std::vector<int32_t> checkpoints;
  for (int tenth = 1; tenth <= 10; ++tenth) {
    const auto at = static_cast<int32_t>((images * static_cast<size_t>(tenth) + 9) / 10);
    if (checkpoints.empty() || checkpoints.back() < at) checkpoints.push_back(at);
  }
  const Flown flown = flyAll(words, options.learning, checkpoints);
  std::vector<size_t> everyone(words.robots.size());
  std::iota(everyone.begin(), everyone.end(), size_t{0});

  Repeat result;
  const auto in_the_end = [&](std::span<const size_t> robots) {
    return inTheEnd(flown, robots, words.cell_size_m, options.learning);
  };
  const std::vector<mapping::LocalBelief> whole_team = in_the_end(everyone);
  {
    const Stacked team = stackTeam(whole_team);
    const TeamTally newest = tally(team.beliefs, truth, FusionRule::kNewestWins);
    for (const matching::MatcherOptions& m : options.matchers) {
      const std::vector<int> labels = labelsOf(team, newest, m);
      result.newest.push_back(score(newest, labels));
      result.matches.push_back(matchQuality(newest, labels));
    }
    result.concatenated =
        scoreAll(team, tally(team.beliefs, truth, FusionRule::kConcatenate), options.matchers);
    result.oracle = score(newest, majorityClasses(newest));
    result.purity = purity(newest);
  }
  for (size_t c = 0; c < checkpoints.size(); ++c) {
    const bool has_landed = c + 1 == checkpoints.size();
    result.by_images.push_back(point(
        checkpoints[c], has_landed ? whole_team : pick(flown.beliefs, everyone, c), truth, options.matchers));
  }

  std::vector<int32_t> parts;  // the single robot's images after 1, 2, ... shares
  const auto first = static_cast<size_t>(options.repeat) % words.robots.size();
  for (size_t i = 0; i < words.robots.size(); ++i) {
    const auto more = static_cast<int32_t>(words.robots[(first + i) % words.robots.size()].size());
    parts.push_back((parts.empty() ? 0 : parts.back()) + more);
  }
  const auto alone =
      learn(words.inOneRow(first), world::RobotId{0}, words.cell_size_m, options.learning, parts);
  result.single = scoreAlone(alone.back(), truth);

  const std::vector<size_t> order = shuffled(words.robots.size(), options.learning.seed);
  for (size_t n = 1; n <= order.size(); ++n) {
    result.by_robots.push_back(
        point(static_cast<int32_t>(n), in_the_end(std::span(order).first(n)), truth, options.matchers));
    result.by_robots.back().single = scoreAlone(alone[n - 1], truth).ami;
  }
  if (options.exchange_every > 0) {
    const MergedTeam merged = learnByMerging(words, options.learning, options.exchange_every);
    result.merged = merged.score;
    result.merged_sent = merged.sent;
    result.merged_received = merged.received;
  }
  if (options.measure_bytes) {
    const auto team = static_cast<double>(words.robots.size());
    for (size_t i = 0; i < words.robots.size(); ++i) {
      const SentBytes sent = bytesSent(words.robots[i], world::RobotId{static_cast<int32_t>(i)},
                                       words.cell_size_m, options.learning);
      result.topics_bytes += static_cast<double>(sent.topics) / team;
      result.map_bytes += static_cast<double>(sent.map) / team;
    }
  }
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::vector<mapping::LocalBelief> flyTeam(const TeamWords& words, const LearningOptions& learning) {
  std::vector<size_t> everyone(words.robots.size());
  std::iota(everyone.begin(), everyone.end(), size_t{0});
  return inTheEnd(flyAll(words, learning, {INT32_MAX}), everyone, words.cell_size_m, learning);
}

std::vector<Score> scoreTeam(const TeamWords& words, const LearningOptions& learning,
                             const std::vector<matching::MatcherOptions>& matchers) {
  const Stacked stacked = stackTeam(flyTeam(words, learning));
  return scoreAll(stacked, tally(stacked.beliefs, words.truthOfCell(), FusionRule::kNewestWins), matchers);
}

std::vector<matching::MatcherOptions> tableMatchers() {
  std::vector<matching::MatcherOptions> matchers = {
      {.matcher = "id", .similarity = "cosine"},          {.matcher = "hungarian", .similarity = "l1"},
      {.matcher = "hungarian", .similarity = "l2"},       {.matcher = "hungarian", .similarity = "cosine"},
      {.matcher = "clear", .similarity = "overlap"},      {.matcher = "clear", .similarity = "cosine"},
      {.matcher = "incremental", .similarity = "cosine"}, {.matcher = "shoal", .similarity = "discounted"},
  };
  return matchers;
}

std::string nameOf(const matching::MatcherOptions& m) {
  if (m.matcher == "id") return "ID";
  if (m.matcher == "hungarian") return "Hungarian, " + m.similarity;
  const std::string known = m.matcher == "clear"         ? "CLEAR, " + m.similarity
                            : m.matcher == "incremental" ? "Incremental, " + m.similarity
                            : m.matcher == "components"  ? "Components, " + m.similarity
                                                         : "Shoal";
  char text[64];
  std::snprintf(text, sizeof text, "%s %.2f", known.c_str(), m.leastSimilarity());
  return text;
}

void to_json(nlohmann::json& json, const Score& s) {
  json = {{"ami", s.ami},       {"nmi", s.nmi},       {"cells", s.cells},
          {"scored", s.scored}, {"labels", s.labels}, {"classes", s.classes}};
}

void from_json(const nlohmann::json& json, Score& s) {
  json.at("ami").get_to(s.ami);
  json.at("nmi").get_to(s.nmi);
  json.at("cells").get_to(s.cells);
  json.at("scored").get_to(s.scored);
  json.at("labels").get_to(s.labels);
  json.at("classes").get_to(s.classes);
}

namespace {

nlohmann::json toJson(const std::vector<Point>& points) {
  nlohmann::json all = nlohmann::json::array();
  for (const Point& p : points) all.push_back({{"at", p.at}, {"ami", p.ami}, {"single", p.single}});
  return all;
}

std::vector<Point> pointsOf(const nlohmann::json& json) {
  std::vector<Point> points;
  for (const nlohmann::json& p : json) {
    points.push_back(
        {p.at("at").get<int32_t>(), p.at("ami").get<std::vector<double>>(), p.at("single").get<double>()});
  }
  return points;
}

}  // namespace

void to_json(nlohmann::json& json, const MatchQuality& q) {
  json = {{"ari", q.ari}, {"precision", q.precision}, {"recall", q.recall}, {"f1", q.f1}};
}

void from_json(const nlohmann::json& json, MatchQuality& q) {
  json.at("ari").get_to(q.ari);
  json.at("precision").get_to(q.precision);
  json.at("recall").get_to(q.recall);
  json.at("f1").get_to(q.f1);
}

void to_json(nlohmann::json& json, const Repeat& r) {
  json = {{"newest", r.newest},
          {"matches", r.matches},
          {"concatenated", r.concatenated},
          {"oracle", r.oracle},
          {"single", r.single},
          {"merged", r.merged},
          {"merged_sent", r.merged_sent},
          {"merged_received", r.merged_received},
          {"purity", r.purity},
          {"topics_bytes", r.topics_bytes},
          {"map_bytes", r.map_bytes},
          {"by_robots", toJson(r.by_robots)},
          {"by_images", toJson(r.by_images)},
          {"seconds", r.seconds}};
}

void from_json(const nlohmann::json& json, Repeat& r) {
  json.at("newest").get_to(r.newest);
  json.at("matches").get_to(r.matches);
  json.at("concatenated").get_to(r.concatenated);
  json.at("oracle").get_to(r.oracle);
  json.at("single").get_to(r.single);
  json.at("merged").get_to(r.merged);
  json.at("merged_sent").get_to(r.merged_sent);
  json.at("merged_received").get_to(r.merged_received);
  json.at("purity").get_to(r.purity);
  json.at("topics_bytes").get_to(r.topics_bytes);
  json.at("map_bytes").get_to(r.map_bytes);
  r.by_robots = pointsOf(json.at("by_robots"));
  r.by_images = pointsOf(json.at("by_images"));
  json.at("seconds").get_to(r.seconds);
}

}  // namespace shoal::eval
