// SPDX-License-Identifier: BSD-3-Clause
// What questions are answered with: area, at, why, node, diff, and how they are asked.
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shoal/mapping/area_answer.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/diff_answer.h"
#include "shoal/mapping/fusion.h"
#include "shoal/mapping/questions.h"
#include "shoal/mapping/stacked_topics.h"
#include "shoal/matching/discounted_similarity.h"

namespace shoal::mapping {
namespace {

using Json = nlohmann::ordered_json;
using world::GlobalLabel;
using world::RobotId;
using world::TopicId;

constexpr int64_t kSecond = 1'000'000;

LocalBelief robot(int number, std::vector<BelievedTopic> topics, std::vector<BelievedCell> cells) {
  return {RobotId{number}, {0, 1}, {{"g", 0, 10}, {"h", 10, 10}}, std::move(topics), std::move(cells)};
}

// Three robots, cells of 2 m. Words 3 (group g) and 12 (group h) make "reef", which robots 0 and 1 know as
// their topics 4 and 5; robot 2's topic 6 has the same word 3 and another in h. Robot 0's topic 7 is alone.
//   reef of R00: cosine to R01/5 = 1; to R02/6 = 1/2, for (8, 8, 0).(8, 0, 8) / 128
std::vector<LocalBelief> threeRobots() {
  return {
      robot(0, {{TopicId{4}, {2 * kSecond}, 16, {{3, 8}, {12, 8}}}, {TopicId{7}, {0}, 5, {{9, 5}}}},
            {{{0, 0, 0}, TopicId{4}, {10 * kSecond}, 1.f},
             {{1, 0, 0}, TopicId{4}, {11 * kSecond}, 0.f},
             {{5, 0, 0}, TopicId{7}, {12 * kSecond}, 1.f}}),
      robot(1, {{TopicId{5}, {3 * kSecond}, 16, {{3, 8}, {12, 8}}}},
            {{{1, 0, 0}, TopicId{5}, {20 * kSecond}, 1.f}}),
      robot(2, {{TopicId{6}, {1 * kSecond}, 16, {{3, 8}, {15, 8}}}},
            {{{1, 0, 0}, TopicId{6}, {15 * kSecond}, 1.f}, {{9, 0, 0}, TopicId{6}, {15 * kSecond}, 1.f}})};
}

class AnswersTest : public testing::Test {
 protected:
  AnswersTest() {
    for (const LocalBelief& b : threeRobots())
      for (const Piece& piece : wholePieces(b)) store_.apply(piece);
    view_.cell_size_m = 2;
    view_.map = fuse(store_, matcher_);
    view_.map.labels.front().name = "reef, \"old\"";
    for (const char* node : {"R00", "R01"}) {
      NodeStatus status;
      status.name = node;
      status.phase = "landed";
      status.heard_s = node == std::string("R00") ? 30 : 41.5;
      view_.nodes.push_back(status);
    }
  }
  Json ask(const Json& question) const {
    return answer({view_, [this]() -> const BeliefStore& { return store_; }, matcher_}, question);
  }

  matching::MatcherOptions matcher_;
  BeliefStore store_;
  MissionView view_;
};

TEST_F(AnswersTest, AreaTellsPatchesWithTheirOutlines) {
  const Json a = ask({{"query", "area"}, {"label", "4"}});
  EXPECT_EQ(a["label"], 4);  // robot 0's topic 4 is the oldest of its cluster
  EXPECT_EQ(a["area_m2"], 8.0);
  ASSERT_EQ(a["patches"].size(), 1u);
  const Json& p = a["patches"][0];
  EXPECT_EQ(p["centroid_m"], Json::parse("[1.0, 0.0]"));
  EXPECT_EQ(p["box_m"], Json::parse("[-1.0, -1.0, 3.0, 1.0]"));
  EXPECT_EQ(p["robots"], Json::parse(R"(["R00", "R01"])"));
  EXPECT_EQ(p["first_seen_s"], 10.0);
  EXPECT_EQ(p["last_seen_s"], 20.0);
  EXPECT_EQ(p["certainty"], 1.0);
  EXPECT_EQ(p["outline_m"], Json::parse("[[[[-1.0,-1.0],[3.0,-1.0],[3.0,1.0],[-1.0,1.0],[-1.0,-1.0]]]]"));
  EXPECT_EQ(ask({{"query", "area"}, {"label", "reef, \"old\""}}), a);
  EXPECT_EQ(ask({{"query", "area"}, {"label", "4"}, {"since_s", 15}})["area_m2"], 4.0);
  EXPECT_EQ(ask({{"query", "area"}, {"label", "4"}, {"min_m2", 8.1}})["patches"].size(), 0u);
}

TEST_F(AnswersTest, AreaIsCsvAndGeoJson) {
  const Json a = ask({{"query", "area"}, {"label", "4"}});
  EXPECT_EQ(areaCsv(a),
            "label,name,patch,area_m2,cells,x_m,y_m,min_x_m,min_y_m,max_x_m,max_y_m,robots,first_seen_s,"
            "last_seen_s,certainty\n"
            "4,\"reef, \"\"old\"\"\",1,8.000,2,1.000,0.000,-1.000,-1.000,3.000,1.000,R00;R01,10.000,20.000,"
            "1.0000\n");
  const Json g = areasGeoJson(Json::array({a}));
  EXPECT_EQ(g["type"], "FeatureCollection");
  EXPECT_EQ(g["features"][0]["geometry"]["type"], "Polygon");
  EXPECT_EQ(g["features"][0]["geometry"]["coordinates"], a["patches"][0]["outline_m"][0]);
  EXPECT_EQ(g["features"][0]["properties"]["label"], 4);
}

TEST_F(AnswersTest, CellsThatMeetAtACornerAreOneFeatureOfTwoPolygons) {
  GlobalMap map;
  for (int i : {0, 1}) map.cells.push_back({{i, i, 0}, GlobalLabel{4}, RobotId{0}, {0}, 1.f});
  map.labels = {{GlobalLabel{4}, "", 2, {RobotId{0}}, {0}}};
  MissionView view;
  view.map = map;
  const Json g = areasGeoJson(areasOf(view));
  ASSERT_EQ(g["features"].size(), 1u);
  EXPECT_EQ(g["features"][0]["geometry"]["type"], "MultiPolygon");
  EXPECT_EQ(g["features"][0]["geometry"]["coordinates"].size(), 2u);
}

TEST_F(AnswersTest, ALabelThatIsNotThereIsNotGuessed) {
  for (const char* text : {"5", "", "reef", "-4", "4 ", "99999999999"}) {
    EXPECT_TRUE(ask({{"query", "area"}, {"label", text}}).contains("error")) << text;
    EXPECT_TRUE(ask({{"query", "why"}, {"label", text}}).contains("error")) << text;
  }
  const std::string said = ask({{"query", "area"}, {"label", "5"}})["error"];
  EXPECT_NE(said.find("no label \"5\""), std::string::npos) << said;
  EXPECT_NE(said.find("4 \"reef"), std::string::npos) << said;
  view_.map.labels.back().name = view_.map.labels.front().name;
  const std::string twice = ask({{"query", "area"}, {"label", view_.map.labels.front().name}})["error"];
  EXPECT_NE(twice.find("2 labels are called"), std::string::npos) << twice;
}

TEST_F(AnswersTest, AtTellsACellsHistoryNewestFirst) {
  const Json cells = ask({{"query", "at"}, {"x", 2.4}, {"y", -0.9}})["cells"];
  ASSERT_EQ(cells.size(), 1u);
  EXPECT_EQ(cells[0]["label"], 4);
  const Json history = Json::parse(R"([
    {"robot": "R01", "topic": 5, "label": 4, "seen_s": 20.0, "certainty": 1.0},
    {"robot": "R02", "topic": 6, "label": 20006, "seen_s": 15.0, "certainty": 1.0},
    {"robot": "R00", "topic": 4, "label": 4, "seen_s": 11.0, "certainty": 0.0}])");
  EXPECT_EQ(cells[0]["history"], history);
}

TEST_F(AnswersTest, WhyTellsWhatIsAlikeAndWhatDecided) {
  const Json a = ask({{"query", "why"}, {"label", "4"}});
  ASSERT_EQ(a["members"].size(), 2u);
  const Json& first = a["members"][0];
  EXPECT_EQ(first["robot"], "R00");
  EXPECT_EQ(first["topic"], 4);
  EXPECT_EQ(first["cells"], 2);
  EXPECT_EQ(first["weight"], 16);
  EXPECT_EQ(first["created_s"], 2.0);
  EXPECT_EQ(first["nearest"],
            Json::parse(R"([{"robot": "R01", "topic": 5, "label": 4, "similarity": 1.0}])"));
  EXPECT_EQ(first["mean_similarity"], 1.0);
  EXPECT_EQ(first["outsider"],
            Json::parse(R"({"robot": "R02", "topic": 6, "label": 20006, "similarity": 0.5})"));
  // Pairs with others: R00/4 and R01/5 with R02/6, and R01/5 with R00/7. Own pairs cannot be joined.
  EXPECT_EQ(a["pairs"], Json::parse(R"({"inside": 1, "inside_reaching_sigma": 1,
                                        "across": 3, "across_reaching_sigma": 0})"));
  EXPECT_EQ(a["margin"], 0.25);  // sigma is .75: 1 and .5 are as far
  EXPECT_EQ(a["nearest_label"], Json::parse(R"({"label": 20006, "mean_similarity": 0.5})"));
  EXPECT_EQ(a["shared_words"], Json::parse(R"([
    {"first": 0, "size": 10, "words": [{"word": 3, "share": 1.0, "members": 2}]},
    {"first": 10, "size": 10, "words": [{"word": 12, "share": 1.0, "members": 2}]}])"));
}

TEST_F(AnswersTest, WhyTellsHowManyPairsWereOutvoted) {
  matcher_.sigma = 0.4;
  const Json a = ask({{"query", "why"}, {"label", "4"}});  // the map is still that of .75
  EXPECT_EQ(a["pairs"]["across_reaching_sigma"], 2);
  EXPECT_EQ(a["margin"], 0.1);
  EXPECT_EQ(a["closest"]["with"]["robot"], "R02");
}

// Its means decide: sigma less the mean similarity to the nearest other label.
TEST_F(AnswersTest, WhySpeaksOfTheMatcherShoalInItsOwnSimilarity) {
  matcher_ = {.matcher = "shoal", .similarity = "discounted"};
  view_.map = fuse(store_, matcher_);
  const StackedTopics stacked = stack(store_);
  const matching::PairTable table = matching::discountedSimilarity(stacked.descriptors);
  const Json a = ask({{"query", "why"}, {"label", "4"}});
  ASSERT_EQ(a["members"].size(), 2u);  // R00/4 and R01/5 have the same words: vertices 0 and 2
  EXPECT_NEAR(a["members"][0]["nearest"][0]["similarity"], table.at(0, 2) * 1e-9, 1e-6);
  EXPECT_EQ(a["nearest_label"]["label"], 20006);
  const double mean = (table.at(0, 3) * 1e-9 + table.at(2, 3) * 1e-9) / 2;
  EXPECT_NEAR(a["nearest_label"]["mean_similarity"], mean, 1e-6);
  EXPECT_NEAR(a["margin"], matching::usualSigma("shoal") - mean, 1e-6);
  EXPECT_EQ(a["sigma"], matching::usualSigma("shoal"));
  EXPECT_TRUE(a["pairs"].is_null());
}

TEST_F(AnswersTest, WhyHasNoMarginWhereSigmaDecidesNothing) {
  for (const char* matcher : {"id", "hungarian"}) {
    matcher_.matcher = matcher;
    const Json a = ask({{"query", "why"}, {"label", "4"}});
    EXPECT_TRUE(a["sigma"].is_null() && a["margin"].is_null() && a["pairs"].is_null()) << matcher;
    EXPECT_EQ(a["members"].size(), 2u);
  }
}

TEST_F(AnswersTest, ALabelWhoseTopicIsUnheardHasNoMembers) {
  BeliefStore store;
  for (const Piece& piece : wholePieces(threeRobots()[0]))
    if (piece.key.kind != PieceKind::kTopic) store.apply(piece);
  view_.map = fuse(store, matcher_);
  const Json a = answer({view_, [&]() -> const BeliefStore& { return store; }, matcher_},
                        {{"query", "why"}, {"label", "4"}});
  EXPECT_TRUE(a["members"].empty());
  EXPECT_EQ(a["cells"], 2);
}

TEST_F(AnswersTest, NodeTellsWhatItToldAndHowOldThatIs) {
  const Json a = ask({{"query", "node"}, {"node", "R00"}});
  EXPECT_EQ(a["node"]["name"], "R00");
  EXPECT_EQ(a["now_s"], 41.5);
  EXPECT_EQ(a["silent_s"], 11.5);
  EXPECT_EQ(a["cells_told"], 3);
  EXPECT_EQ(a["cells_shown"], 2);  // robot 1 saw one of them later
  EXPECT_EQ(a["told_until_s"], 12.0);
  EXPECT_EQ(a["behind_s"], 18.0);
  ASSERT_EQ(a["topics"].size(), 2u);
  EXPECT_EQ(a["topics"][0]["topic"], 4);
  EXPECT_EQ(a["topics"][0]["label"], 4);
  EXPECT_EQ(a["topics"][0]["cells"], 2);
  EXPECT_NE(ask({{"query", "node"}, {"node", "R07"}})["error"].get<std::string>().find("R00 R01"),
            std::string::npos);
}

TEST_F(AnswersTest, NodeIsAnsweredAlikeFromARecordingsTimesAndFromAFilesMilliseconds) {
  for (int64_t us = 18'572'000; us < 18'576'000; ++us) {
    view_.nodes[0].heard_s = world::Timestamp{us}.seconds();
    view_.nodes[1].heard_s = world::Timestamp{us + us % 1777}.seconds();
    const Json recorded = ask({{"query", "node"}, {"node", "R00"}});
    for (NodeStatus& node : view_.nodes) node = nodeFromJson(toJson(node));
    ASSERT_EQ(ask({{"query", "node"}, {"node", "R00"}}), recorded) << us;
  }
}

TEST_F(AnswersTest, WhatIsNoQuestionIsAnErrorAndHurtsNobody) {
  for (const char* text :
       {"{}", R"({"query": "what"})", R"({"query": 7})", R"({"query": "at"})",
        R"({"query": "at", "x": "a", "y": 0})", R"({"query": "area"})", R"({"query": "area", "label": 4})",
        R"({"query": "area", "label": "4", "min_m2": -1})",
        R"({"query": "area", "label": "4", "certainty": 2})",
        R"({"query": "area", "label": "4", "since_s": 1e300})", R"({"query": "why", "label": []})",
        R"({"query": "node"})"}) {
    EXPECT_TRUE(ask(Json::parse(text)).contains("error")) << text;
  }
}

TEST(DiffAnswerTest, TellsWhatChangedByWhom) {
  const auto cell = [](int x, int label, int robot, int seen_s) {
    return GlobalCell{{x, 0, 0}, GlobalLabel{label}, RobotId{robot}, {seen_s * kSecond}, 1.f};
  };
  MissionView before, after;
  before.map.cells = {cell(0, 1, 0, 5), cell(1, 1, 0, 5), cell(2, 1, 0, 5), cell(4, 1, 0, 5)};
  after.map.cells = {cell(0, 1, 0, 5),   // as it was
                     cell(1, 2, 0, 5),   // relabelled
                     cell(2, 2, 1, 9),   // seen by robot 1
                     cell(3, 2, 1, 8)};  // appeared; cell 4 is gone
  after.map.labels = {{GlobalLabel{1}, "sand", 1, {}, {0}}};
  const Json d = diffAnswer(before, 6, after, 10);
  EXPECT_EQ(d["total"], Json::parse(R"({"appeared": 1, "seen": 1, "relabelled": 1, "gone": 1})"));
  EXPECT_EQ(d["robots"], Json::parse(R"([
    {"robot": "R00", "appeared": 0, "seen": 0, "relabelled": 1, "gone": 1},
    {"robot": "R01", "appeared": 1, "seen": 1, "relabelled": 0, "gone": 0}])"));
  EXPECT_EQ(d["labels"], Json::parse(R"([
    {"label": 1, "name": "sand", "area_before_m2": 4.0, "area_after_m2": 1.0},
    {"label": 2, "name": "", "area_before_m2": 0.0, "area_after_m2": 3.0}])"));
  EXPECT_EQ(diffCsv(d),
            "x_m,y_m,z_m,change,before,after,robot,seen_s\n"
            "1.000,0.000,0.000,relabelled,1,2,R00,5.000\n"
            "2.000,0.000,0.000,seen,1,2,R01,9.000\n"
            "3.000,0.000,0.000,appeared,,2,R01,8.000\n"
            "4.000,0.000,0.000,gone,1,,R00,5.000\n");
}

TEST(DiffAnswerTest, OfAMapWithItselfIsNothing) {
  MissionView view;
  view.map.cells = {{{0, 0, 0}, GlobalLabel{1}, RobotId{0}, {0}, 1.f}};
  const Json d = diffAnswer(view, 0, view, 0);
  EXPECT_TRUE(d["changes"].empty());
  EXPECT_TRUE(d["robots"].empty());
}

}  // namespace
}  // namespace shoal::mapping
