// SPDX-License-Identifier: BSD-3-Clause
// A mission that grows, robots joining late: global labels keep their numbers.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <numeric>
#include <tuple>
#include <utility>
#include <vector>

#include "shoal/eval/team_learning.h"
#include "shoal/eval/team_words.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/fused_map.h"
#include "shoal/world/place.h"

namespace shoal::eval {
namespace {

using world::GlobalLabel;
using world::RobotId;
using world::TopicId;
using Topic = std::pair<RobotId, TopicId>;

constexpr int32_t kTeam = 4, kImages = 16, kEvery = 2;
constexpr int32_t kLater = 4;  // a robot takes off so many images after the one before

// What each robot believes after every second image of its own, in mission time.
std::vector<std::vector<mapping::LocalBelief>> flights(uint64_t seed) {
  const auto place = world::openPlace("reef:tuning", seed);
  world::SurveyOptions survey;
  survey.num_robots = kTeam;
  survey.observations = kImages;
  TeamWords words = lookAround(*place, seed, survey, "best", {});
  std::vector<int32_t> checkpoints(kImages / kEvery);
  for (size_t i = 0; i < checkpoints.size(); ++i) checkpoints[i] = kEvery * (static_cast<int32_t>(i) + 1);
  std::vector<std::vector<mapping::LocalBelief>> all;
  for (int32_t r = 0; r < kTeam; ++r) {
    auto& images = words.robots[static_cast<size_t>(r)];
    for (world::WordsInCells& image : images) image.time.us += int64_t{1'000'000} * kLater * r;
    all.push_back(learn(images, RobotId{r}, words.cell_size_m,
                        {.profile = "best", .seed = seed, .hyperparameters = {}}, checkpoints));
  }
  return all;
}

std::map<Topic, GlobalLabel> labelsOf(const mapping::FusedMap& map) {
  std::map<Topic, GlobalLabel> labels;
  for (const mapping::Correspondence& c : map.correspondences()) labels[{c.robot, c.topic}] = c.label;
  return labels;
}

// The oldest topic of every label, by creation time, then robot, then id.
std::map<GlobalLabel, Topic> oldestOf(const std::map<Topic, GlobalLabel>& labels,
                                      const mapping::BeliefStore& beliefs) {
  std::map<GlobalLabel, std::tuple<int64_t, RobotId, TopicId>> oldest;
  beliefs.visitTopics([&](const mapping::Piece& piece) {
    const Topic topic{piece.key.robot, TopicId{piece.key.index[0]}};
    const auto label = labels.find(topic);
    if (piece.part != 0 || label == labels.end()) return;
    const std::tuple age(std::get<mapping::TopicPart>(piece.content).created.us, topic.first, topic.second);
    const auto known = oldest.emplace(label->second, age).first;
    known->second = std::min(known->second, age);
  });
  std::map<GlobalLabel, Topic> topics;
  for (const auto& [label, age] : oldest) topics[label] = {std::get<1>(age), std::get<2>(age)};
  return topics;
}

TEST(GrowingMissionTest, ALabelLivesAsLongAsItsOldestTopic) {
  int64_t kept = 0, flipped = 0;
  for (const uint64_t seed : {2, 3}) {
    const auto robots = flights(seed);
    mapping::BeliefStore beliefs;
    mapping::FusedMap map;
    std::vector<mapping::BeliefChanges> changes(kTeam);
    std::map<world::CellIndex, std::pair<Topic, GlobalLabel>> before;
    std::map<GlobalLabel, Topic> oldest_before;
    for (int32_t now = kEvery; now <= kImages + kLater * (kTeam - 1); now += kEvery) {
      std::map<world::CellIndex, Topic> shown;  // robots' shares do not overlap: no robot overrules another
      for (int32_t r = 0; r < kTeam; ++r) {
        const int32_t flown = std::min(now - kLater * r, kImages);
        if (flown <= 0) continue;
        const auto& belief = robots[static_cast<size_t>(r)][static_cast<size_t>(flown / kEvery - 1)];
        for (const mapping::Piece& piece : changes[static_cast<size_t>(r)].update(belief))
          beliefs.apply(piece);
        for (const mapping::BelievedCell& c : belief.cells) shown[c.cell] = {RobotId{r}, c.topic};
      }
      map.update(beliefs, matching::usualMatcher());
      const auto labels = labelsOf(map);
      const auto oldest = oldestOf(labels, beliefs);
      for (const auto& [label, topic] : oldest)
        EXPECT_EQ(label, world::globalLabel(topic.first, topic.second));

      // A topic that has given its name to a label goes on to do so unless it left, or joined an older one.
      for (const auto& [label, topic] : oldest_before) {
        const auto still = labels.find(topic);
        if (still == labels.end()) continue;
        EXPECT_TRUE(still->second == label || oldest.at(still->second) != topic);
      }
      std::map<world::CellIndex, std::pair<Topic, GlobalLabel>> after;
      for (const auto& [cell, topic] : shown) {
        const auto label = labels.find(topic);
        if (label != labels.end()) after[cell] = {topic, label->second};
      }
      for (const auto& [cell, was] : before) {
        const auto is = after.find(cell);
        if (is == after.end() || is->second.first != was.first) continue;  // its robot thinks otherwise now
        ++(is->second.second == was.second ? kept : flipped);
      }
      before = std::move(after);
      oldest_before = oldest;
    }
  }
  std::printf("labels of cells that stayed with their topics: %d kept, %d flipped\n", static_cast<int>(kept),
              static_cast<int>(flipped));
  EXPECT_GT(kept, 50'000);
  EXPECT_LT(static_cast<double>(flipped), 0.25 * static_cast<double>(kept));
}

}  // namespace
}  // namespace shoal::eval
