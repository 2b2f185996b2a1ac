// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/example_book.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <opencv2/core.hpp>
#include <stdexcept>

#include "shoal/robot/cell_view.h"
#include "shoal/world/pose.h"

namespace shoal::robot {
namespace {

// A camera 8 m above a flat floor: 25 pixels a metre, so that a cell of .8 m is 20 pixels wide.
world::Observation image(int number, int blue = 0) {
  world::Observation o;
  o.number = number;
  o.time = {number * int64_t{1'000'000}};
  o.color = cv::Mat(240, 320, CV_8UC3, cv::Scalar(blue, 0, 0));
  o.depth_m = cv::Mat(240, 320, CV_32FC1, cv::Scalar(8.f));
  o.world_from_camera = world::lookingDown({0, 0, 8});
  return o;
}

TEST(CellViewTest, IsTwoCellsWideAroundTheCell) {
  const auto view = viewOf(image(0), {0, 0, 0}, world::Grid(0.8));
  ASSERT_TRUE(view);
  EXPECT_EQ(view->side, 40);
  EXPECT_EQ(view->left, 139);  // 159.5 - 20
  EXPECT_EQ(view->top, 99);
  const auto beside = viewOf(image(0), {2, 1, 0}, world::Grid(0.8));  // x to the right, y up
  ASSERT_TRUE(beside);
  EXPECT_EQ(beside->left, 139 + 40);
  EXPECT_EQ(beside->top, 99 - 20);
}

TEST(CellViewTest, WhatIsCutOffHiddenOrBehindIsNotSeenWhole) {
  const world::Grid grid(0.8);
  EXPECT_TRUE(viewOf(image(0), {6, 0, 0}, grid));
  EXPECT_FALSE(viewOf(image(0), {8, 0, 0}, grid));   // at the right border
  EXPECT_FALSE(viewOf(image(0), {0, 0, 11}, grid));  // above the camera
  EXPECT_FALSE(viewOf(image(0), {0, 0, 9}, grid));   // so near that it fills the image
  world::Observation hidden = image(0);
  hidden.depth_m = cv::Scalar(5.f);
  EXPECT_FALSE(viewOf(hidden, {0, 0, 0}, grid));
  hidden.depth_m = cv::Scalar(std::nanf(""));
  EXPECT_FALSE(viewOf(hidden, {0, 0, 0}, grid));
  EXPECT_FALSE(viewOf(image(0), {0, 0, 0}, world::Grid(0.1)));  // 5 pixels
}

TEST(CellViewTest, PixelsAreMeansOfWhatTheyCover) {
  world::Observation o = image(0);
  for (int y = 0; y < 240; ++y)
    for (int x = 0; x < 320; ++x)
      o.color.at<cv::Vec3b>(y, x) = {static_cast<uint8_t>(x % 2), 10, static_cast<uint8_t>(y)};
  const auto rgb = cutOut(o, {100, 50, 4}, 2);
  EXPECT_EQ(rgb, (std::vector<uint8_t>{51, 10, 1, 51, 10, 1, 53, 10, 1, 53, 10, 1}));  // 50.5 and .5 round up
  EXPECT_EQ(cutOut(o, {100, 50, 2}, 4).size(), 48u);  // fewer pixels than asked for: repeated
}

// A topic that is half of word 0, which all have, and half of a word of its own.
mapping::LocalBelief twoTopics() {
  mapping::LocalBelief belief{
      .robot = {}, .version = {0, 0}, .groups = {{"all", 0, 4}}, .topics = {}, .cells = {}};
  belief.topics = {{world::TopicId{0}, {0}, 200, {{0, 100}, {1, 100}}},
                   {world::TopicId{5}, {0}, 200, {{0, 100}, {2, 100}}}};
  return belief;
}

// By hand: roots of frequencies are sqrt(.5) for both own words; over all topics sqrt(.5) and sqrt(.25). Left
// are sqrt(.5) / 2 = .3536 and sqrt(.5) - .25 = .4571, of length .5779.
TEST(TypicalityTest, IsTheCosineOfRootsDiscounted) {
  const Typicality typicality(twoTopics());
  const double both = (std::sqrt(.5) * .35355 + std::sqrt(.5) * .45711) / .57788;
  EXPECT_NEAR(typicality.of({{0, 7}, {1, 7}}, world::TopicId{0}), both * Typicality::kMost, 10);
  EXPECT_NEAR(typicality.of({{1, 3}}, world::TopicId{0}), .45711 / .57788 * Typicality::kMost, 10);
  EXPECT_EQ(typicality.of({{3, 3}}, world::TopicId{0}), 0);
  EXPECT_EQ(typicality.of({}, world::TopicId{0}), 0);
  EXPECT_EQ(typicality.of({{0, 1}}, world::TopicId{9}), 0);
}

struct Flight {
  ExampleBook book{0.8};
  mapping::LocalBelief belief = twoTopics();

  // One image in which these cells have these topics, certainties and words.
  struct Cell {
    world::CellIndex cell;
    int topic;
    float certainty;
    std::vector<world::WordCount> words;
  };
  void look(int number, const std::vector<Cell>& cells, int blue = 0) {
    belief.version.observation = number;
    world::WordsInCells words{.observation = number, .time = {}, .cells = {}};
    for (const Cell& c : cells) {
      words.cells.push_back({c.cell, c.words});
      std::erase_if(belief.cells, [&](const auto& held) { return held.cell == c.cell; });
      belief.cells.push_back({c.cell, world::TopicId{c.topic}, {}, c.certainty});
    }
    std::ranges::sort(belief.cells, {}, &mapping::BelievedCell::cell);
    book.look(image(number, blue), words, belief);
  }
};

const std::vector<world::WordCount> kTypical = {{0, 5}, {1, 5}}, kLess = {{0, 9}, {1, 1}}, kLeast = {{0, 9}};

TEST(ExampleBookTest, TakesTheMostTypicalCellAndPrefersCertainOnes) {
  Flight flight;
  flight.look(0,
              {{{0, 0, 0}, 0, 1, kLess}, {{1, 0, 0}, 0, 1, kTypical}, {{2, 0, 0}, 5, 1, {{0, 1}, {2, 1}}}});
  auto examples = flight.book.examples();
  ASSERT_EQ(examples.size(), 2u);
  EXPECT_EQ(examples[0].cell, (world::CellIndex{1, 0, 0}));
  EXPECT_EQ(number(examples[1].topic), 5);
  EXPECT_EQ(examples[0].rgb.size(), size_t{3} * 32 * 32);

  Flight sure;
  sure.look(0, {{{0, 0, 0}, 0, .2f, kTypical}, {{1, 0, 0}, 0, 1, kTypical}});
  EXPECT_EQ(sure.book.examples().at(0).cell, (world::CellIndex{1, 0, 0}));
  Flight tie;
  tie.look(0, {{{0, 0, 0}, 0, 1, kTypical}, {{1, 0, 0}, 0, 1, kTypical}});
  EXPECT_EQ(tie.book.examples().at(0).cell, (world::CellIndex{0, 0, 0}));
}

TEST(ExampleBookTest, TheSecondExampleShowsAnotherPlace) {
  Flight flight;
  flight.look(0, {{{0, 0, 0}, 0, 1, kTypical}});
  flight.look(1, {{{2, 0, 0}, 0, 1, kTypical}});  // overlaps the first
  EXPECT_EQ(flight.book.examples().size(), 1u);
  flight.look(2, {{{4, 0, 0}, 0, 1, kTypical}});
  ASSERT_EQ(flight.book.examples().size(), 2u);
  EXPECT_EQ(flight.book.examples()[1].cell, (world::CellIndex{4, 0, 0}));
  EXPECT_EQ(flight.book.examples()[1].observation, 2);
}

TEST(ExampleBookTest, AnExampleChangesOnlyForAClearlyBetterOneAndWithGrowingPatience) {
  Flight flight;
  flight.look(0, {{{0, 0, 0}, 0, .8f, kTypical}});
  flight.look(20, {{{1, 0, 0}, 0, .9f, kTypical}});  // 1.9 / 1.8 is no eighth
  EXPECT_EQ(flight.book.examples().at(0).observation, 0);
  flight.look(21, {{{0, 0, 0}, 0, .5f, kTypical}, {{1, 1, 0}, 0, 1, kTypical}});
  EXPECT_EQ(flight.book.examples().at(0).observation, 21);
  EXPECT_EQ(flight.book.examples().at(0).cell, (world::CellIndex{1, 1, 0}));
}

TEST(ExampleBookTest, ItChangesAtMostSoOftenHoweverTheTopicDrifts) {
  Flight flight;
  int changes = 0, last = -1;
  for (int number = 0; number < 256; ++number) {  // every cell is the best so far
    const auto certainty = static_cast<float>(number) / 255.f;
    for (auto& cell : flight.belief.cells) cell.certainty = 0;
    flight.look(number, {{{number % 5, number / 5 % 3, 0}, 0, certainty, kTypical}});
    const int now = flight.book.examples().at(0).observation;
    if (now != last) ++changes;
    last = now;
  }
  EXPECT_LE(changes, 7);  // log2(256 / 4) + 1
  EXPECT_GE(changes, 3);
}

TEST(ExampleBookTest, ATopicThatIsGoneTakesItsPicturesWithIt) {
  Flight flight;
  flight.look(0, {{{0, 0, 0}, 0, 1, kTypical}, {{4, 0, 0}, 5, 1, {{2, 4}}}});
  flight.belief.topics.erase(flight.belief.topics.begin());
  std::erase_if(flight.belief.cells, [](const auto& cell) { return number(cell.topic) == 0; });
  flight.look(3, {{{4, 0, 0}, 5, 1, {{2, 4}}}});
  const auto examples = flight.book.examples();
  ASSERT_EQ(examples.size(), 2u);
  EXPECT_TRUE(examples[0].rgb.empty());
  EXPECT_EQ(examples[0].observation, 3);
  flight.look(4, {});
  EXPECT_EQ(flight.book.examples()[0].observation, 3);  // said once
}

TEST(ExampleBookTest, ResumesFromItsCheckpointAsIfItHadNeverStopped) {
  Flight flight, resumed;
  const auto fly = [](Flight& f, int number) {
    f.look(number,
           {{{number % 6, number % 4, 0},
             number % 3 == 0 ? 5 : 0,
             static_cast<float>(number) / 40.f,
             number % 2 == 0 ? kTypical : kLess}},
           number);
  };
  for (int number = 0; number < 20; ++number) fly(flight, number);
  resumed.belief = flight.belief;
  resumed.book.restore(flight.book.checkpoint(), 4);
  EXPECT_EQ(resumed.book.examples(), flight.book.examples());
  for (int number = 20; number < 40; ++number) {
    fly(flight, number);
    fly(resumed, number);
    EXPECT_EQ(resumed.book.examples(), flight.book.examples());
  }
  EXPECT_EQ(resumed.book.checkpoint(), flight.book.checkpoint());
  std::vector<uint8_t> damaged = flight.book.checkpoint();
  damaged[damaged.size() / 2] ^= 1;
  EXPECT_THROW(resumed.book.restore(damaged, 4), std::runtime_error);
  EXPECT_THROW(resumed.book.restore(flight.book.checkpoint(), 1),
               std::runtime_error);  // words of another robot
}

}  // namespace
}  // namespace shoal::robot
