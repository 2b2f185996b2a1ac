// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/team_opinion.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <vector>

#include "shoal/topics/fixed_log.h"

namespace shoal::topics {
namespace {

using world::RobotId;
using world::WordCount;

const std::vector<world::WordGroup> kGroups = {{"g", 0, 8}};
const std::map<int32_t, int32_t> kLabels = {{40, 0}, {50, 1}};  // 60 is no label of this robot
constexpr int64_t kVote = TeamOpinion::kBitsOfAll * kLogOne;

struct Answer {
  std::vector<int64_t> log_likelihoods, in_favour;
};

Answer ask(const TeamTopics& team, const std::vector<WordCount>& words, std::vector<int64_t> own) {
  TeamOpinion opinion(kGroups, 1.0, team, kLabels);
  Answer answer{std::move(own), std::vector<int64_t>(2, 77)};
  int64_t num_words = 0;
  for (const WordCount& w : words) num_words += w.count;
  opinion.ask(words, num_words, answer.log_likelihoods, answer.in_favour);
  return answer;
}

// Of eight words, beta 1: a topic of n words gives a word that it has m times (m + 1) / (n + 8).
TEST(TeamOpinionTest, ALabelFitsAsWellAsTheBestOfItsTopics) {
  const TeamTopics team = {.own = {},
                           .others = {{RobotId{1}, 40, {{0, 7}, {1, 1}}},
                                      {RobotId{1}, 50, {{1, 8}}},
                                      {RobotId{2}, 40, {{0, 3}, {1, 5}}}}};
  const int64_t low = -100 * kLogOne;
  const Answer answer = ask(team, {{0, 1}, {2, 1}}, {low, low});
  // 8/16 x 1/16 by the first topic, 1/16 x 1/16 by the second, 4/16 x 1/16 by the third.
  EXPECT_NEAR(static_cast<double>(answer.log_likelihoods[0]) / kLogOne, -5, 1e-3);
  EXPECT_NEAR(static_cast<double>(answer.log_likelihoods[1]) / kLogOne, -8, 1e-3);
  EXPECT_EQ(ask(team, {{0, 1}, {2, 1}}, {0, low}).log_likelihoods[0], 0);  // what was better stays
}

TEST(TeamOpinionTest, EachOtherRobotVotesForWhatItsBestTopicIs) {
  const TeamTopics team = {.own = {},
                           .others = {{RobotId{1}, 40, {{0, 8}}},
                                      {RobotId{1}, 50, {{1, 8}}},
                                      {RobotId{2}, 40, {{0, 4}, {3, 4}}},
                                      {RobotId{2}, 60, {{1, 8}}},
                                      {RobotId{7}, 50, {{1, 4}, {4, 4}}}}};
  const std::vector<int64_t> low(2, -100 * kLogOne);
  // The word 0 has 9/16 by R01, 5/16 by R02, which is .85 bits less, and 1/16 by R07, which knows nothing
  // like it.
  EXPECT_EQ(ask(team, {{0, 2}}, low).in_favour, (std::vector<int64_t>{2 * (kVote / 4), 0}));
  // R02 votes for what does not count.
  EXPECT_EQ(ask(team, {{1, 2}}, low).in_favour, (std::vector<int64_t>{0, 2 * (kVote / 4)}));
  // The first among equals.
  EXPECT_EQ(ask(team, {{5, 1}}, low).in_favour, (std::vector<int64_t>{2 * (kVote / 4), kVote / 4}));
  // The robot's own topics explain all: R02, 1.68 bits a word behind, abstains.
  EXPECT_EQ(ask(team, {{0, 2}}, {0, 0}).in_favour, (std::vector<int64_t>{kVote / 4, 0}));
}

TEST(TeamOpinionTest, WithoutOthersThereIsNone) {
  const Answer answer = ask({}, {{0, 1}}, {-5, -7});
  EXPECT_EQ(answer.log_likelihoods, (std::vector<int64_t>{-5, -7}));
  EXPECT_EQ(answer.in_favour, (std::vector<int64_t>{0, 0}));
}

}  // namespace
}  // namespace shoal::topics
