// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/experiment.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <vector>

#include "shoal/eval/merging_team.h"
#include "shoal/eval/word_file.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/robot/explorer.h"
#include "shoal/robot/team_topics.h"

namespace shoal::eval {
namespace {

constexpr int kRobots = 3;

class ExperimentTest : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    place_ = world::openPlace("reef:tuning", 2).release();
    survey_.num_robots = kRobots;
    survey_.observations = 6;
    words_ = new TeamWords(lookAround(*place_, 2, survey_, "paper", {}));
  }
  static void TearDownTestSuite() {
    delete words_;
    delete place_;
  }

  static world::Place* place_;
  static world::SurveyOptions survey_;
  static TeamWords* words_;
};
world::Place* ExperimentTest::place_ = nullptr;
world::SurveyOptions ExperimentTest::survey_;
TeamWords* ExperimentTest::words_ = nullptr;

TEST_F(ExperimentTest, ARobotBelievesWhatItBelievesInFlight) {
  robot::Explorer in_flight({.robot = world::RobotId{1},
                             .profile = "paper",
                             .seed = 5,
                             .cell_size_m = words_->cell_size_m,
                             .hyperparameters = {}});
  const auto source = place_->source(survey_, 1);
  while (const auto observation = source->next()) in_flight.observe(*observation);
  const mapping::LocalBelief flown = in_flight.belief();
  const std::vector<int32_t> all{3, 6};
  const auto learnt = learn(words_->robots[1], world::RobotId{1}, words_->cell_size_m,
                            {.profile = "paper", .seed = 5, .hyperparameters = {}}, all);
  EXPECT_EQ(learnt[1].topics, flown.topics);
  EXPECT_EQ(learnt[1].cells, flown.cells);
  EXPECT_LT(learnt[0].cells.size(), flown.cells.size());
}

TEST_F(ExperimentTest, OneRowIsWhatTheRobotThatFliesAloneSees) {
  robot::Explorer in_flight({.robot = world::RobotId{0},
                             .profile = "paper",
                             .seed = 5,
                             .cell_size_m = words_->cell_size_m,
                             .hyperparameters = {}});
  const auto source = place_->source(survey_, 0, true);
  while (const auto observation = source->next()) in_flight.observe(*observation);
  const std::vector<int32_t> all{6 * kRobots};
  const auto learnt = learn(words_->inOneRow(0), world::RobotId{0}, words_->cell_size_m,
                            {.profile = "paper", .seed = 5, .hyperparameters = {}}, all);
  EXPECT_EQ(learnt[0].cells, in_flight.belief().cells);
  // From another share on: the same images in another order.
  EXPECT_EQ(words_->inOneRow(1)[0].cells.size(), words_->robots[1][0].cells.size());
  EXPECT_EQ(words_->inOneRow(1).size(), words_->inOneRow(0).size());
}

// As robot_agent: each with what all had told when they had landed, and not with what the first made of it.
TEST_F(ExperimentTest, ATeamLooksAgainWhenItHasLanded) {
  const LearningOptions best{.profile = "best", .seed = 5, .hyperparameters = {}};
  const TeamWords seen = lookAround(*place_, 2, survey_, "best", {});
  LearningOptions once = best;
  once.looks_again = false;
  const auto flown = flyTeam(seen, once), looked = flyTeam(seen, best);
  mapping::BeliefStore heard;
  for (const mapping::LocalBelief& belief : flown)
    for (const mapping::Piece& piece : mapping::wholePieces(belief)) heard.apply(piece);
  for (size_t i = 0; i < flown.size(); ++i) {
    robot::Explorer mind({.robot = flown[i].robot,
                          .profile = "best",
                          .seed = 5,
                          .cell_size_m = seen.cell_size_m,
                          .hyperparameters = {}});
    for (const world::WordsInCells& words : seen.robots[i]) mind.learn(words);
    EXPECT_EQ(mind.belief().cells, flown[i].cells);
    mind.lookAgain(robot::teamTopics(heard, flown[i].robot, matching::usualMatcher()));
    EXPECT_EQ(mind.belief().cells, looked[i].cells);
    EXPECT_EQ(mind.belief().version, looked[i].version);
    EXPECT_NE(looked[i].cells, flown[i].cells);
    EXPECT_EQ(looked[i].topics, flown[i].topics);
  }
}

TEST_F(ExperimentTest, TruthIsThatOfTheWholeTeamsFrames) {
  const TruthOfCell expected =
      truthFor(*place_, place_->completed(survey_), world::Grid(words_->cell_size_m));
  const TruthOfCell kept = words_->truthOfCell();
  size_t known = 0;
  for (const auto& robot : words_->robots) {
    for (const world::WordsInCells& image : robot) {
      for (const world::CellWords& c : image.cells) {
        ASSERT_EQ(kept(c.cell), expected(c.cell));
        known += kept(c.cell).has_value();
      }
    }
  }
  EXPECT_GT(known, 1000u);
}

TEST_F(ExperimentTest, WordsKeptOnDiskAreTheSameAndBrokenFilesAreMadeAnew) {
  const std::string folder = ::testing::TempDir() + "/shoal_words";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  std::atomic<int64_t> images{0};
  for (int pass = 0; pass < 3; ++pass) {
    images = 0;
    const TeamWords words =
        lookAround(*place_, 2, survey_, "paper", {.folder = folder, .made_by = "test", .images = &images});
    EXPECT_EQ(images, 6 * kRobots);
    EXPECT_EQ(words.truth, words_->truth);
    for (size_t robot = 0; robot < kRobots; ++robot) {
      ASSERT_EQ(words.robots[robot].size(), words_->robots[robot].size());
      for (size_t n = 0; n < words.robots[robot].size(); ++n) {
        const world::WordsInCells &a = words.robots[robot][n], &b = words_->robots[robot][n];
        ASSERT_EQ(a.cells.size(), b.cells.size());
        for (size_t c = 0; c < a.cells.size(); ++c) {
          ASSERT_EQ(a.cells[c].cell, b.cells[c].cell);
          ASSERT_EQ(a.cells[c].words, b.cells[c].words);
        }
      }
    }
    if (pass == 1) {
      for (const auto& entry : std::filesystem::directory_iterator(folder)) {
        std::filesystem::resize_file(entry.path(), std::filesystem::file_size(entry.path()) / 2);
      }
    }
  }
  std::filesystem::remove_all(folder);
}

TEST_F(ExperimentTest, ARepeatIsAFunctionOfItsSeedAndSurvivesItsFile) {
  RepeatOptions options{.learning = {.profile = "paper", .seed = 7, .hyperparameters = {}},
                        .matchers = tableMatchers(),
                        .repeat = 1,
                        .exchange_every = 3,
                        .measure_bytes = true};
  Repeat first = runRepeat(*words_, options), second = runRepeat(*words_, options);
  first.seconds = second.seconds = 0;
  EXPECT_EQ(nlohmann::json(first), nlohmann::json(second));
  EXPECT_EQ(nlohmann::json(nlohmann::json::parse(nlohmann::json(first).dump()).get<Repeat>()),
            nlohmann::json(first));
  options.learning.seed = 8;
  EXPECT_NE(runRepeat(*words_, options).newest[0].ami, first.newest[0].ami);

  ASSERT_EQ(first.newest.size(), options.matchers.size());
  ASSERT_EQ(first.by_robots.size(), static_cast<size_t>(kRobots));
  EXPECT_EQ(first.by_images.back().at, 6);
  // The whole team at the end is the whole team, but for the order the sequential matcher meets it in.
  EXPECT_EQ(first.by_images.back().ami[5], first.newest[5].ami);
  EXPECT_NEAR(first.by_robots.back().single, first.single.ami, 1e-12);
  EXPECT_GT(first.topics_bytes, 1000);
  EXPECT_GT(first.merged_received, first.merged_sent);
  EXPECT_GT(first.merged.scored, 1000);
}

// Whoever merges only at the very end has learnt alone.
TEST_F(ExperimentTest, MergingOnceAtTheEndIsMatchingAtTheEnd) {
  const LearningOptions learning{.profile = "paper", .seed = 3, .hyperparameters = {}};
  const MergedTeam merged = learnByMerging(*words_, learning, 100);
  EXPECT_LE(merged.score.labels, 12);
  const MergedTeam often = learnByMerging(*words_, learning, 2);
  EXPECT_GT(often.sent, merged.sent);
  EXPECT_NE(often.score.ami, merged.score.ami);
  EXPECT_THROW(learnByMerging(*words_, learning, 0), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::eval
