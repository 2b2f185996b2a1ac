// SPDX-License-Identifier: BSD-3-Clause
// Names that a mission begins with.
#include "shoal/mapping/library.h"

#include <algorithm>
#include <stdexcept>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/fused_map.h"
#include "shoal/mapping/fusion.h"
#include "shoal/mapping/judgement.h"
#include "shoal/mapping/questions.h"

namespace shoal::mapping {
namespace {

using world::GlobalLabel;
using world::RobotId;
using world::TopicId;

matching::MatcherOptions matcher() { return {.matcher = "components", .similarity = "cosine"}; }

// R00 has seen words 7 (topic 0: sand) and 8 (topic 1: coral), a cell each.
BeliefStore mission(int32_t third_word = 9) {
  BeliefStore store;
  const LocalBelief belief{RobotId{0},
                           {0, 1},
                           {{"g", 0, 100}},
                           {{TopicId{0}, {0}, 50, {{7, 50}}},
                            {TopicId{1}, {5}, 50, {{8, 50}}},
                            {TopicId{2}, {6}, 50, {{third_word, 50}}}},
                           {{{0, 0, 0}, TopicId{0}, {0}, 1.f},
                            {{1, 0, 0}, TopicId{1}, {1}, 1.f},
                            {{2, 0, 0}, TopicId{2}, {2}, 1.f}}};
  for (const Piece& piece : wholePieces(belief)) store.apply(piece);
  return store;
}

void call(BeliefStore& store, int topic, const std::string& text, int counter, int64_t time_us = 10) {
  store.apply(pieceOf(Edit{.id = {"OPERATOR", counter},
                           .time = {time_us},
                           .operation = NameEdit{{RobotId{0}, 0, TopicId{topic}}, text}}));
}

Library twoNames() { return {{100}, {{"brain coral", 30, {{8, 30}}}, {"wreck", 9, {{55, 9}}}}}; }

void enter(BeliefStore& store, const Library& library) {
  for (const Piece& piece : piecesOf(library)) store.apply(piece);
}

TEST(LibraryTest, HoldsWhatWasNamedAndNothingElse) {
  BeliefStore store = mission();
  call(store, 0, "sand", 1);
  call(store, 1, "coral", 2);
  const Library library = libraryOf(fuse(store, matcher()), store);
  EXPECT_EQ(library, (Library{{100}, {{"coral", 50, {{8, 50}}}, {"sand", 50, {{7, 50}}}}}));
}

TEST(LibraryTest, ComesBackFromItsFile) {
  EXPECT_EQ(parseLibrary(libraryJson(twoNames()), "f"), twoNames());
  EXPECT_EQ(digestOf(parseLibrary(libraryJson(twoNames()), "f")), digestOf(twoNames()));
}

TEST(LibraryTest, ComesBackFromTheStateInAnyOrder) {
  BeliefStore store;
  auto pieces = piecesOf(twoNames());
  std::ranges::reverse(pieces);
  for (const Piece& piece : pieces) store.apply(piece);
  EXPECT_EQ(libraryIn(store), twoNames());
  EXPECT_EQ(store.epochOf(kLibrary), epochOf(twoNames()));
}

TEST(LibraryTest, WhatIsKnownArrivesNamedAndTheMapStaysTheSame) {
  BeliefStore store = mission();
  const GlobalMap before = fuse(store, matcher());
  enter(store, twoNames());
  const GlobalMap map = fuse(store, matcher());
  EXPECT_EQ(map.cells, before.cells);  // labels are numbered by robots' topics, never by the library's
  ASSERT_EQ(map.labels.size(), 3u);
  EXPECT_EQ(map.labels[0].name, "");
  EXPECT_EQ(map.labels[1].name, "brain coral");
  EXPECT_EQ(map.labels[1].robots, std::vector{RobotId{0}});
  EXPECT_EQ(map.labels[1].first_seen, before.labels[1].first_seen);
  const std::map<GlobalLabel, std::vector<std::string>> expected = {
      {GlobalLabel{1}, {"brain coral"}}, {world::globalLabel(kLibrary, TopicId{1}), {"wreck"}}};
  EXPECT_EQ(libraryNames(map, store), expected);
}

TEST(LibraryTest, TheFusedMapOfAGrowingStateHasItToo) {
  BeliefStore store = mission();
  FusedMap fused;
  fused.update(store, matcher());
  enter(store, twoNames());
  fused.update(store, matcher());
  const GlobalMap map = fuse(store, matcher());
  EXPECT_EQ(fused.digest(), map.digest());
  EXPECT_EQ(fused.labels()[1].name, "brain coral");
}

TEST(LibraryTest, WhoNamesALabelLaterDecidesAndUndoBringsTheLibrarysNameBack) {
  BeliefStore store = mission();
  enter(store, twoNames());
  call(store, 1, "fire coral", 1);
  EXPECT_EQ(fuse(store, matcher()).labels[1].name, "fire coral");
  store.apply(pieceOf(Edit{.id = {"OPERATOR", 2}, .time = {20}, .operation = UndoEdit{{"OPERATOR", 1}}}));
  EXPECT_EQ(fuse(store, matcher()).labels[1].name, "brain coral");
}

TEST(LibraryTest, ExcludedLikeARobotItIsAsIfItHadNeverBeen) {
  BeliefStore store = mission();
  enter(store, twoNames());
  store.apply(pieceOf(Edit{.id = {"OPERATOR", 1}, .time = {20}, .operation = ExcludeEdit{kLibrary}}));
  const GlobalMap map = fuse(store, matcher()), without = fuse(mission(), matcher());
  EXPECT_EQ(map.cells, without.cells);
  EXPECT_EQ(map.digest(), without.digest());
}

// Whatever comes first: the greater epoch counts, and the other's names do not.
TEST(LibraryTest, OfTwoThatMeetOneCountsOnEveryNode) {
  const Library other{{100}, {{"mud", 30, {{8, 30}}}}};
  BeliefStore a = mission(), b = mission();
  enter(a, twoNames());
  enter(a, other);
  enter(b, other);
  enter(b, twoNames());
  EXPECT_EQ(a.digest(), b.digest());
  const Library& winner = epochOf(other) > epochOf(twoNames()) ? other : twoNames();
  EXPECT_EQ(libraryIn(a), winner);
  EXPECT_EQ(fuse(a, matcher()).labels[1].name, winner.topics[0].name);
  EXPECT_EQ(fuse(a, matcher()).digest(), fuse(b, matcher()).digest());
}

TEST(LibraryTest, OfAnotherVocabularyItMatchesNothing) {
  BeliefStore store = mission();
  Library other = twoNames();
  other.group_sizes = {40, 60};
  enter(store, other);
  EXPECT_EQ(fuse(store, matcher()).labels[1].name, "");
}

TEST(LibraryTest, KeepsWhatItHadAndTakesUpWhatIsNew) {
  BeliefStore store = mission();
  enter(store, twoNames());
  call(store, 0, "sand", 1);
  const Library next = libraryOf(fuse(store, matcher()), store);
  EXPECT_EQ(
      next,
      (Library{{100}, {{"brain coral", 80, {{8, 80}}}, {"sand", 50, {{7, 50}}}, {"wreck", 9, {{55, 9}}}}}));
}

TEST(LibraryTest, LabelsSayWhatTheLibraryCallsThem) {
  BeliefStore store = mission();
  const auto ask = [&] {
    MissionView view;
    view.map = fuse(store, matcher());
    return answer({view, [&]() -> const BeliefStore& { return store; }, matcher()},
                  {{"query", "labels"}})["labels"];
  };
  EXPECT_FALSE(ask()[1].contains("library"));
  enter(store, twoNames());
  EXPECT_EQ(ask()[1]["library"], std::vector<std::string>{"brain coral"});
  EXPECT_EQ(ask()[0]["library"], std::vector<std::string>{});
}

TEST(LibraryTest, WrongFilesAreRefusedByName) {
  const std::string good = libraryJson(twoNames());
  const auto refusal = [](const std::string& text) -> std::string {
    try {
      parseLibrary(text, "f.library");
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "read";
  };
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = good;
    text.replace(text.find(from), from.size(), to);
    return refusal(text);
  };
  EXPECT_NE(refusal("{").find("f.library"), std::string::npos);
  EXPECT_NE(with("\"shoal_library\": 1", "\"shoal_library\": 2").find("format 2"), std::string::npos);
  EXPECT_NE(with("\"wreck\"", "\"brain coral\"").find("there twice"), std::string::npos);
  EXPECT_NE(with("\"wreck\"", "\"\"").find("1 to 64 bytes"), std::string::npos);
  EXPECT_NE(with("\"55\"", "\"155\"").find("vocabulary of 100"), std::string::npos);
  EXPECT_NE(with("\"55\": 9", "\"55\": 0").find("a count"), std::string::npos);
  EXPECT_NE(with("\"weight\": 9", "\"weight\": -9").find("a weight"), std::string::npos);
  EXPECT_NE(with("\"55\": 9", "\"55\": 9.5").find("a count"), std::string::npos);
}

}  // namespace
}  // namespace shoal::mapping
