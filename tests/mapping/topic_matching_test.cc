// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/topic_matching.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/label_identity.h"

namespace shoal::mapping {
namespace {

using world::GlobalLabel;
using world::RobotId;
using world::TopicId;

Topic topic(int robot, int number) { return {RobotId{robot}, TopicId{number}}; }

// Robot r knows word 7 as topic 0 and word 8 + r as topic 1; robot 3 has another vocabulary.
BeliefStore fourRobots() {
  BeliefStore store;
  for (int r = 0; r < 4; ++r) {
    const auto believed = [r](int id, int32_t word) {
      return BelievedTopic{TopicId{id}, {100 - r}, 50, {{word, 50}}};
    };
    const LocalBelief belief{RobotId{r},
                             {0, 1},
                             {{"g", 0, r == 3 ? 99 : 100}},
                             {believed(0, 7), believed(1, 8 + r)},
                             {{{r, 0, 0}, TopicId{0}, {1}, 1.f}, {{r, 1, 0}, TopicId{1}, {1}, 1.f}}};
    for (const Piece& piece : wholePieces(belief)) store.apply(piece);
  }
  return store;
}

std::map<std::pair<int, int>, int> labels(const Judgement& judgement, const std::string& matcher = "shoal") {
  const StackedTopics stacked = stack(fourRobots(), judgement.excluded);
  const matching::MatcherOptions options{.matcher = matcher,
                                         .similarity = matching::usualSimilarity(matcher)};
  const std::vector<GlobalLabel> global = stableLabels(stacked, matchTopics(stacked, options, judgement));
  std::map<std::pair<int, int>, int> label;
  for (size_t i = 0; i < global.size(); ++i)
    label[{number(stacked.topics[i].robot), number(stacked.topics[i].id)}] = number(global[i]);
  return label;
}

Judgement judgementOf(std::vector<TopicPair> links, std::vector<TopicPair> apart) {
  Judgement judgement;
  judgement.links = std::move(links);
  judgement.apart = std::move(apart);
  return judgement;
}

TEST(MatchTopicsTest, LinksAndExclusionsDecide) {
  auto label = labels({});
  EXPECT_EQ((label[{0, 0}]), 20000);  // robots 0, 1 and 2 share word 7; robot 2's topic is the oldest
  EXPECT_EQ((label[{1, 0}]), 20000);
  EXPECT_EQ((label[{3, 0}]), 30000);
  label = labels(judgementOf({{topic(0, 1), topic(1, 1)}}, {{topic(0, 0), topic(2, 0)}}));
  EXPECT_NE((label[{0, 0}]), (label[{2, 0}]));
  EXPECT_EQ((label[{0, 1}]), 10001);
  EXPECT_EQ((label[{1, 1}]), 10001);
}

TEST(MatchTopicsTest, ALinkReachesRobotsOfAnotherVocabulary) {
  auto label = labels(judgementOf({{topic(0, 0), topic(3, 0)}}, {}));
  EXPECT_EQ((label[{3, 0}]), 30000);  // the oldest of all
  EXPECT_EQ((label[{0, 0}]), 30000);
  EXPECT_EQ((label[{2, 0}]), 30000);
  EXPECT_EQ((label[{3, 1}]), 30001);
}

TEST(MatchTopicsTest, ALinkHoldsByWayOfATopicThatWasNotHeard) {
  const auto unheard = topic(2, 77);
  auto label = labels(judgementOf({{topic(0, 1), unheard}, {topic(1, 1), unheard}}, {}));
  EXPECT_EQ((label[{0, 1}]), (label[{1, 1}]));
  EXPECT_EQ(label.size(), 8u);
}

// As if it had never been heard: no link goes by way of a robot that is left out.
TEST(MatchTopicsTest, ARobotThatIsLeftOutJoinsNothing) {
  Judgement judgement = judgementOf({{topic(0, 1), topic(1, 1)}, {topic(0, 1), topic(2, 1)}}, {});
  judgement.excluded = {RobotId{0}};
  auto label = labels(judgement);
  EXPECT_NE((label[{1, 1}]), (label[{2, 1}]));
  EXPECT_EQ(label.size(), 6u);
}

TEST(MatchTopicsTest, EveryMatcherHonoursThem) {
  for (const std::string& matcher : matching::matcherNames()) {
    SCOPED_TRACE(matcher);
    auto label = labels(
        judgementOf({{topic(0, 1), topic(2, 1)}, {topic(2, 1), topic(3, 1)}}, {{topic(1, 0), topic(2, 0)}}),
        matcher);
    EXPECT_NE((label[{1, 0}]), (label[{2, 0}]));
    EXPECT_EQ((label[{0, 1}]), (label[{2, 1}]));
    EXPECT_EQ((label[{3, 1}]), (label[{2, 1}]));
  }
}

}  // namespace
}  // namespace shoal::mapping
