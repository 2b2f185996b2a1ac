// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/topic_groups.h"

#include <algorithm>
#include <map>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::mapping {
namespace {

Topic topic(int number) { return {world::RobotId{number / 100}, world::TopicId{number % 100}}; }

// The definition: every pair that was set apart is looked at again for every link.
class PlainGroups {
 public:
  bool add(const Topic& first, const Topic& second, bool apart) {
    const Topic a = rootOf(first), b = rootOf(second);
    if (apart) {
      if (a != b) apart_.push_back({first, second});
      return a != b;
    }
    for (const auto& [c, d] : apart_) {
      const Topic e = rootOf(c), f = rootOf(d);
      if ((e == a && f == b) || (e == b && f == a)) return false;
    }
    if (a != b) parent_[std::max(a, b)] = std::min(a, b);
    return true;
  }

 private:
  Topic rootOf(Topic topic) const {
    for (auto up = parent_.find(topic); up != parent_.end(); up = parent_.find(topic)) topic = up->second;
    return topic;
  }
  std::map<Topic, Topic> parent_;
  std::vector<std::pair<Topic, Topic>> apart_;
};

TEST(TopicGroupsTest, TakesWhatTheDefinitionTakes) {
  Random random(1);
  for (int trial = 0; trial < 300; ++trial) {
    TopicGroups groups;
    PlainGroups plain;
    const uint64_t topics = 2 + random.below(40), in_ten_apart = random.below(11);
    for (int edit = 0; edit < 120; ++edit) {
      const Topic a = topic(static_cast<int>(random.below(topics)) * 37);
      const Topic b = topic(static_cast<int>(random.below(topics)) * 37);
      const bool apart = random.below(10) < in_ten_apart;
      ASSERT_EQ(groups.add(a, b, apart), plain.add(a, b, apart)) << "trial " << trial << ", edit " << edit;
    }
  }
}

//   0 - 1 - 2 - ...     each apart from one of 5000 others: by the definition 5000 x 5000 pairs are looked
//   at, |   |   |           and to find the root of each takes up to 5000 steps
TEST(TopicGroupsTest, TenThousandEditsTakeAFewStepsEach) {
  constexpr int kEdits = 5000;
  TopicGroups groups;
  for (int i = 0; i < kEdits; ++i) EXPECT_TRUE(groups.add(topic(i), topic(kEdits + i), true));
  for (int i = kEdits - 1; i > 0; --i) EXPECT_TRUE(groups.add(topic(i - 1), topic(i), false));
  EXPECT_FALSE(groups.add(topic(0), topic(2 * kEdits - 1), false));
  EXPECT_LT(groups.steps(), size_t{2 * kEdits} * 30);
}

// The other way round: what has most to stay apart from has fewest topics.
TEST(TopicGroupsTest, AGroupThatManyStayApartFromIsNotToldAnewToAll) {
  constexpr int kEdits = 5000;
  TopicGroups groups;
  for (int i = 0; i < kEdits; ++i) EXPECT_TRUE(groups.add(topic(0), topic(kEdits + i), true));
  for (int i = 1; i < kEdits; ++i) EXPECT_TRUE(groups.add(topic(i), topic(i - 1), false));
  EXPECT_FALSE(groups.add(topic(kEdits), topic(kEdits - 1), false));
  EXPECT_LT(groups.steps(), size_t{2 * kEdits} * 30);
}

}  // namespace
}  // namespace shoal::mapping
