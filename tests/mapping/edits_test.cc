// SPDX-License-Identifier: BSD-3-Clause
// What operators decide: which edits count, and what they do to the map.
#include <algorithm>
#include <filesystem>

#include <unistd.h>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/belief_files.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/edit_question.h"
#include "shoal/mapping/edits_answer.h"
#include "shoal/mapping/edits_file.h"
#include "shoal/mapping/fusion.h"
#include "shoal/mapping/judgement.h"
#include "shoal/mapping/map_files.h"
#include "shoal/random.h"

namespace shoal::mapping {
namespace {

using world::GlobalLabel;
using world::RobotId;
using world::TopicId;
using Json = nlohmann::ordered_json;

BelievedTopic topic(int id, int64_t created_us, int32_t word) {
  return {TopicId{id}, {created_us}, 50, {{word, 50}}};
}

// Robots 0, 1 and 2 all know word 7 (topics 0, 3, 5; the oldest is 10003), and each one thing of its own.
LocalBelief robot(int number) {
  const std::vector<std::vector<BelievedTopic>> topics = {{topic(0, 20, 7), topic(1, 0, 8)},
                                                          {topic(2, 5, 9), topic(3, 10, 7)},
                                                          {topic(5, 30, 7), topic(6, 40, 11)}};
  LocalBelief belief{RobotId{number}, {0, 1}, {{"g", 0, 100}}, topics[static_cast<size_t>(number)], {}};
  Random random(static_cast<uint64_t>(number));
  for (int x = 0; x < 12; ++x) {
    belief.cells.push_back({{x + 3 * number, 0, 0},
                            belief.topics[random.below(2)].id,
                            {static_cast<int64_t>(random.below(5)) * 1'000'000},
                            static_cast<float>(random.uniform())});
  }
  return belief;
}

BeliefStore storeOf(const std::vector<int>& robots) {
  BeliefStore store;
  for (const int r : robots)
    for (const Piece& piece : wholePieces(robot(r))) store.apply(piece);
  return store;
}

matching::MatcherOptions matcher() { return {.matcher = "components", .similarity = "cosine"}; }

TopicRef ref(int label, int epoch = 0) { return {RobotId{label / 10000}, epoch, TopicId{label % 10000}}; }

Edit name(const std::string& author, int counter, int64_t at, int label, const std::string& text) {
  return {{author, counter}, {at}, NameEdit{ref(label), text}};
}
Edit link(const std::string& author, int counter, int64_t at, int a, int b, bool apart) {
  return {{author, counter}, {at}, LinkEdit{ref(a), ref(b), apart}};
}
Edit exclude(const std::string& author, int counter, int64_t at, int r) {
  return {{author, counter}, {at}, ExcludeEdit{RobotId{r}}};
}
Edit undo(const std::string& author, int counter, int64_t at, const EditId& what) {
  return {{author, counter}, {at}, UndoEdit{what}};
}

std::vector<Standing> standings(BeliefStore& store, const std::vector<Edit>& edits) {
  for (const Edit& e : edits) store.apply(pieceOf(e));
  std::vector<Standing> became;
  judge(editsOf(store), store, &became);
  return became;
}

std::string nameOf(const BeliefStore& store, int label) {
  for (const LabelSummary& row : fuse(store, matcher()).labels)
    if (row.label == GlobalLabel{label}) return row.name;
  return "no such label";
}

TEST(EditsTest, ANameSticksToTheTopicAndTheNewestOfAClusterWins) {
  BeliefStore store = storeOf({0, 1, 2});
  store.apply(pieceOf(name("A", 1, 100, 0, "sand")));  // R00's topic 0, of label 10003
  EXPECT_EQ(nameOf(store, 10003), "sand");
  store.apply(pieceOf(name("A", 2, 200, 20005, "mud")));  // R02's topic of the same label, later
  EXPECT_EQ(nameOf(store, 10003), "mud");
  store.apply(pieceOf(name("B", 1, 150, 10003, "silt")));  // heard late, made before
  EXPECT_EQ(nameOf(store, 10003), "mud");
  EXPECT_EQ(nameOf(store, 1), "");
  store.apply(pieceOf(name("B", 2, 300, 10003, "")));
  EXPECT_EQ(nameOf(store, 10003), "");
}

TEST(EditsTest, UndoIsAnOperationAndCanBeUndone) {
  BeliefStore store = storeOf({0, 1, 2});
  using enum Standing;
  EXPECT_EQ(standings(store, {name("A", 1, 100, 1, "rock"), undo("B", 1, 200, {"A", 1})}),
            (std::vector{kUndone, kInForce}));
  EXPECT_EQ(nameOf(store, 1), "");
  EXPECT_EQ(standings(store, {undo("A", 2, 300, {"B", 1})}), (std::vector{kInForce, kUndone, kInForce}));
  EXPECT_EQ(nameOf(store, 1), "rock");
  EXPECT_EQ(standings(store, {undo("A", 3, 400, {"C", 9})}).back(), kVoid);
}

TEST(EditsTest, TheNewestDecidesOnATopicAndItsPair) {
  using enum Standing;
  BeliefStore store = storeOf({0, 1, 2});
  EXPECT_EQ(
      standings(store, {name("A", 1, 1, 1, "x"), name("B", 1, 1, 1, "y"),  // at once: the greater author
                        link("A", 2, 2, 1, 10002, false), link("A", 3, 3, 1, 10002, true)}),
      (std::vector{kReplaced, kInForce, kReplaced, kInForce}));
  const Judgement judgement = judge(store);
  EXPECT_TRUE(judgement.links.empty());
  EXPECT_EQ(judgement.apart.size(), 1u);
  EXPECT_EQ(nameOf(store, 1), "y");
}

TEST(EditsTest, ALinkThatContradictsNewerOnesDoesNotCount) {
  using enum Standing;
  BeliefStore store = storeOf({0, 1, 2});
  EXPECT_EQ(standings(store, {link("A", 1, 1, 1, 10002, false), link("A", 2, 2, 10002, 20006, false),
                              link("A", 3, 3, 1, 20006, true)}),
            (std::vector{kOverruled, kInForce, kInForce}));
  BeliefStore other = storeOf({0, 1, 2});
  EXPECT_EQ(standings(other, {link("A", 1, 1, 1, 20006, true), link("A", 2, 2, 1, 10002, false),
                              link("A", 3, 3, 10002, 20006, false)}),
            (std::vector{kOverruled, kInForce, kInForce}));
}

TEST(EditsTest, WhatWasSaidOfAnEarlierLifeIsVoid) {
  BeliefStore store = storeOf({0, 1, 2});
  Piece reborn = wholePieces(robot(0)).front();
  reborn.version.epoch = 1;
  store.apply(reborn);
  EXPECT_EQ(standings(store, {name("A", 1, 1, 0, "old"), {{"A", 2}, {2}, NameEdit{ref(0, 1), "new"}}}),
            (std::vector{Standing::kVoid, Standing::kInForce}));
}

std::string bytesOf(const GlobalMap& map) {
  const world::Grid grid(0.5);
  return globalMapCsv(map, grid) + labelsCsv(map, grid);
}

TEST(EditsTest, LinksAndExclusionsDecideWhatIsFused) {
  const auto labelOf = [](const BeliefStore& store, int topic) {
    for (const Correspondence& c : fuse(store, matcher()).correspondences)
      if (number(world::globalLabel(c.robot, c.topic)) == topic) return number(c.label);
    return -1;
  };
  BeliefStore store = storeOf({0, 1, 2});
  const GlobalMap before = fuse(store, matcher());
  const auto& c = before.correspondences;
  const auto of = [](const Correspondence& m) { return number(world::globalLabel(m.robot, m.topic)); };
  int counter = 0;
  for (size_t i = 0; i < c.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const bool apart = c[i].label == c[j].label;
      ++counter;
      store.apply(pieceOf(link("A", counter, counter, of(c[j]), of(c[i]), apart)));
      EXPECT_EQ(labelOf(store, of(c[i])) == labelOf(store, of(c[j])), !apart);
    }
  }
  EXPECT_GT(counter, 2);
}

TEST(EditsTest, WithoutARobotIsTheVeryMapOfAMissionWithoutIt) {
  for (const int gone : {0, 1, 2}) {
    std::vector<int> others = {0, 1, 2};
    std::erase(others, gone);
    const BeliefStore without = storeOf(others);
    BeliefStore excluded = storeOf({0, 1, 2});
    excluded.apply(pieceOf(exclude("A", 1, 0, gone)));
    for (const std::string m : {"id", "hungarian", "components", "clear", "shoal"}) {
      const matching::MatcherOptions options{.matcher = m, .similarity = matching::usualSimilarity(m)};
      const GlobalMap expected = fuse(without, options), map = fuse(excluded, options);
      EXPECT_EQ(bytesOf(map), bytesOf(expected)) << m << " without " << gone;
      EXPECT_EQ(map.digest(), expected.digest());
    }
    const GlobalMap whole = fuse(storeOf({0, 1, 2}), matcher());
    EXPECT_NE(bytesOf(fuse(excluded, matcher())), bytesOf(whole));
    excluded.apply(pieceOf(undo("A", 2, 1, {"A", 1})));
    EXPECT_EQ(bytesOf(fuse(excluded, matcher())), bytesOf(whole));
  }
}

// A robot whose certainties lie near the borders between ninths.
LocalBelief bordering(int r) {
  LocalBelief belief = robot(r);
  for (size_t i = 0; i < belief.cells.size(); ++i)
    belief.cells[i].certainty = (static_cast<float>(i % 9) + 0.5f) / 9.f + (i % 2 == 0 ? 2e-6f : -2e-6f);
  return belief;
}

// The files of a run add up to the map that was made from what travelled, certainties included.
TEST(EditsTest, ThroughTheFilesToo) {
  const std::string folder = testing::TempDir() + "edits" + std::to_string(::getpid());
  const world::Grid grid(0.5);
  BeliefStore from_files;
  for (const int r : {0, 1, 2}) {
    const LocalBelief belief = bordering(r);
    writeBelief(folder, belief, grid);
    LocalBelief read = readBelief(folder, RobotId{r}, grid);
    for (size_t i = 0; i < belief.cells.size(); ++i) {
      EXPECT_NEAR(read.cells[i].certainty, belief.cells[i].certainty, 1.01e-4);
      BelievedCell exact = belief.cells[i], written = read.cells[i];
      EXPECT_EQ(certaintySteps(written.certainty), certaintySteps(exact.certainty)) << written.certainty;
    }
    for (const Piece& piece : wholePieces(read)) from_files.apply(piece);
  }
  std::filesystem::remove_all(folder);
  from_files.apply(pieceOf(exclude("A", 1, 0, 1)));
  BeliefStore without;
  for (const int r : {0, 2}) {
    for (const Piece& piece : wholePieces(bordering(r))) without.apply(piece);
  }
  const GlobalMap expected = fuse(without, matcher());
  GlobalMap read = parseGlobalMap(globalMapCsv(expected, grid), labelsCsv(expected, grid), grid, "test");
  EXPECT_EQ(globalMapCsv(fuse(from_files, matcher()), grid), globalMapCsv(read, grid));
}

// Whatever order edits and robots come in, and however often: one state, one map.
TEST(EditsTest, EqualStateEqualMap) {
  std::vector<Piece> pieces;
  for (const int r : {0, 1, 2})
    for (Piece& piece : wholePieces(robot(r))) pieces.push_back(std::move(piece));
  for (const Edit& e :
       {name("A", 1, 5, 0, "a"), name("B", 1, 5, 10003, "b"), link("A", 2, 6, 1, 10002, false),
        link("B", 2, 6, 10002, 20006, true), link("A", 3, 7, 1, 20006, false), exclude("B", 3, 8, 2),
        undo("A", 4, 9, {"B", 3}), undo("B", 4, 9, {"A", 2})}) {
    pieces.push_back(pieceOf(e));
    pieces.push_back(pieceOf(e));
  }
  Random random(3);
  std::string bytes;
  uint64_t digest = 0;
  for (int trial = 0; trial < 20; ++trial) {
    for (size_t i = pieces.size(); i > 1; --i) std::swap(pieces[i - 1], pieces[random.below(i)]);
    BeliefStore store;
    for (const Piece& piece : pieces) EXPECT_NE(store.apply(piece), Applied::kConflict);
    const GlobalMap map = fuse(store, matcher());
    if (trial == 0) {
      bytes = bytesOf(map);
      digest = store.digest();
    }
    ASSERT_EQ(bytesOf(map), bytes);
    ASSERT_EQ(store.digest(), digest);
  }
}

TEST(EditsTest, TheStoreKeepsALimitedNumber) {
  BeliefStore store({.max_edits = 2});
  EXPECT_EQ(store.apply(pieceOf(exclude("A", 1, 1, 1))), Applied::kNew);
  EXPECT_EQ(store.apply(pieceOf(exclude("A", 2, 2, 1))), Applied::kNew);
  EXPECT_EQ(store.apply(pieceOf(exclude("A", 3, 3, 1))), Applied::kRejected);
  EXPECT_EQ(store.apply(pieceOf(exclude("A", 2, 2, 1))), Applied::kDuplicate);
}

TEST(EditsTest, FilesGiveBackWhatWasWritten) {
  const std::vector<Edit> edits = {name("A", 1, 5, 10003, "Seegr\xc3\xa4ser \"hoch\""),
                                   link("A", 2, 6, 1, 10002, true), link("A", 3, 6, 1, 10002, false),
                                   exclude("SHIP2", 1, 7, 9999),
                                   undo("A", 4, int64_t{1} << 61, {"SHIP2", 1})};
  const EditsFile read = parseEdits(editsJson(77, edits), "edits.json");
  EXPECT_EQ(read.mission, 77);
  EXPECT_EQ(read.edits, edits);
}

TEST(EditsTest, WhatIsWrongInAFileIsNamed) {
  const Json good = Json::parse(editsJson(1, std::vector{name("A", 1, 5, 10003, "x")}));
  const auto refused = [](const Json& json) {
    EXPECT_THROW(parseEdits(json.dump(), "edits.json"), std::runtime_error) << json;
  };
  EXPECT_NO_THROW(parseEdits(good.dump(), "edits.json"));
  for (const char* key : {"id", "time_us", "edit", "topics", "name"}) {
    Json json = good;
    json["edits"][0].erase(key);
    refused(json);
    json["edits"][0][key] = Json::array({1});
    refused(json);
  }
  for (const auto& [key, value] : {std::pair<const char*, Json>{"id", "a/1"},
                                   {"id", "A/0"},
                                   {"id", "A"},
                                   {"time_us", -1},
                                   {"time_us", 1.5},
                                   {"time_us", 9e30},
                                   {"edit", "rename"},
                                   {"name", "\n"}}) {
    Json json = good;
    json["edits"][0][key] = value;
    refused(json);
  }
  Json json = good;
  json["edits"][0]["topics"][0]["topic"] = 10000;
  refused(json);
  json["edits"] = 5;
  refused(json);
  EXPECT_THROW(parseEdits("{", "edits.json"), std::runtime_error);
}

class QuestionTest : public testing::Test {
 protected:
  Edit ask(const Json& question, const std::string& author = "A") {
    const Edit edit = makeEdit(fuse(store_, matcher()), store_, question, author, {1'000});
    store_.apply(pieceOf(edit));
    return edit;
  }
  void refused(const Json& question, const std::string& said) {
    try {
      ask(question);
      FAIL() << question;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(said), std::string::npos) << error.what();
    }
  }
  BeliefStore store_ = storeOf({0, 1, 2});
};

TEST_F(QuestionTest, LabelsAreNumbersNamesOrTopics) {
  ask({{"edit", "name"}, {"label", "10003"}, {"text", "sand"}});
  const Edit again = ask({{"edit", "name"}, {"label", "sand"}, {"text", "silt"}});
  EXPECT_EQ(std::get<NameEdit>(again.operation).topic, ref(10003));
  const Edit split = ask({{"edit", "unlink"}, {"a", "20005"}, {"b", 10003}});
  EXPECT_EQ(split.operation, (decltype(split.operation)(LinkEdit{ref(10003), ref(20005), true})));
  EXPECT_EQ(sentenceOf(split), "10003 and 20005 are not the same");
}

TEST_F(QuestionTest, EditsOfOneAuthorFollowEachOther) {
  const Edit first = ask({{"edit", "exclude"}, {"robot", "R01"}});
  const Edit second = ask({{"edit", "undo"}});
  EXPECT_EQ(toText(second.id), "A/2");
  EXPECT_LT(first.time, second.time);  // though both were asked for at 1 ms
  const Edit other = ask({{"edit", "exclude"}, {"robot", "R01"}}, "B");
  EXPECT_EQ(toText(other.id), "B/1");
  EXPECT_LT(second.time, other.time);
  const Json told = editsAnswer(store_);
  EXPECT_EQ(told["excluded"], Json::array({"R01"}));
  EXPECT_EQ(told["edits"][0]["standing"], "undone");
  EXPECT_EQ(told["edits"][1]["says"], "A/1 is undone");
}

TEST_F(QuestionTest, WhatIsWrongIsNamed) {
  refused({{"edit", "name"}, {"label", "77"}, {"text", "x"}}, "no label \"77\"");
  refused({{"edit", "name"}, {"label", "1"}, {"text", std::string(65, 'x')}}, "at most 64 bytes");
  refused({{"edit", "name"}, {"label", "1"}, {"text", "10004"}}, "is a number");
  refused({{"edit", "link"}, {"a", "1"}, {"b", "1"}}, "twice");
  refused({{"edit", "exclude"}, {"robot", "R77"}}, "heard were R00 R01 R02");
  refused({{"edit", "undo"}}, "no edit in force");
  refused({{"edit", "undo"}, {"which", "A/9"}}, "no edit \"A/9\"");
  refused({{"edit", "forget"}}, "no edit");
  ask({{"edit", "exclude"}, {"robot", "R02"}});
  refused({{"edit", "exclude"}, {"robot", "R02"}}, "excluded already");
  ask({{"edit", "undo"}});
  refused({{"edit", "undo"}, {"which", "A/1"}}, "undone already");
}

}  // namespace
}  // namespace shoal::mapping
