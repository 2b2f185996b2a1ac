// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/live_source.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "shoal/random.h"

namespace shoal::world {
namespace {

constexpr int kWidth = 8, kHeight = 6;

LiveOptions usual() {
  LiveOptions options;
  options.camera.intrinsics = {kWidth, kHeight, 10, 10, 3.5, 2.5};
  return options;
}

Timestamp ms(int64_t time) { return {time * 1000}; }
cv::Mat color(int blue) { return cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(blue, 0, 0)); }
cv::Mat depth(double metres) { return cv::Mat(kHeight, kWidth, CV_32FC1, cv::Scalar(metres)); }
TimedPose pose(int64_t time, double x) { return {ms(time), {x, 0, 9}, Eigen::Quaterniond(0, 1, 0, 0)}; }

std::vector<Observation> takeAll(LiveSource& source) {
  std::vector<Observation> all;
  while (auto seen = source.next()) all.push_back(std::move(*seen));
  return all;
}

TEST(LiveSourceTest, APictureComesOutWhenItsPoseAndDepthAreThere) {
  LiveSource source(usual());
  source.addColor(ms(5000), color(1));
  EXPECT_FALSE(source.ready());
  source.addDepth(ms(5000), depth(2));
  EXPECT_FALSE(source.ready());
  source.addPose(pose(5000, 7));
  ASSERT_TRUE(source.ready());
  const auto seen = source.next();
  EXPECT_EQ(seen->number, 0);
  EXPECT_EQ(seen->time.us, 0);
  EXPECT_EQ(seen->color.at<cv::Vec3b>(1, 1)[0], 1);
  EXPECT_EQ(seen->depth_m.at<float>(1, 1), 2.0f);
  EXPECT_EQ(seen->world_from_camera.translation(), Eigen::Vector3d(7, 0, 9));
  EXPECT_EQ(seen->intrinsics.fx, 10);
  EXPECT_FALSE(source.ready());
  EXPECT_FALSE(source.hasEnded());
}

TEST(LiveSourceTest, ALatePoseIsWaitedForAndInterpolated) {
  LiveSource source(usual());
  source.addPose(pose(0, 0));
  source.addColor(ms(30), color(1));
  source.addDepth(ms(30), depth(1));
  source.addColor(ms(60), color(2));
  source.addDepth(ms(60), depth(2));
  EXPECT_FALSE(source.ready());  // a nearer pose may come
  source.addPose(pose(40, 4));
  ASSERT_TRUE(source.ready());
  EXPECT_NEAR(source.next()->world_from_camera.translation().x(), 3.0, 1e-12);
  EXPECT_FALSE(source.ready());
  source.addPose(pose(80, 8));
  const auto second = source.next();
  EXPECT_NEAR(second->world_from_camera.translation().x(), 6.0, 1e-12);
  EXPECT_EQ(second->time.us, 30'000);
  EXPECT_EQ(source.troubles(), "");
}

TEST(LiveSourceTest, TheNearestDepthWithinTheToleranceIsTaken) {
  LiveSource source(usual());
  source.addPose(pose(100, 0));
  source.addDepth(ms(82), depth(1));
  source.addColor(ms(100), color(1));
  EXPECT_FALSE(source.ready());  // a depth picture at 100 may come
  source.addDepth(ms(110), depth(2));
  ASSERT_TRUE(source.ready());
  EXPECT_EQ(source.next()->depth_m.at<float>(0, 0), 2.0f);
}

TEST(LiveSourceTest, WaitingIsBoundedAndWhatLacksIsCounted) {
  LiveOptions options = usual();
  options.max_waiting = 3;
  LiveSource source(options);
  // Poses stop after picture 1; depth is missing for picture 0.
  source.addPose(pose(0, 0));
  source.addPose(pose(100, 1));
  for (int i = 0; i < 6; ++i) {
    source.addColor(ms(100 * i), color(i));
    if (i > 0) source.addDepth(ms(100 * i), depth(1));
  }
  const auto seen = takeAll(source);
  ASSERT_EQ(seen.size(), 1u);
  EXPECT_EQ(seen[0].color.at<cv::Vec3b>(0, 0)[0], 1);
  EXPECT_EQ(source.troubles(),
            "1 pictures without a pose, 1 pictures without depth");  // 2; and 0. 3 to 5 wait
  source.addPose(pose(500, 5));
  EXPECT_EQ(takeAll(source).size(), 3u);  // 400 ms are no gap
}

TEST(LiveSourceTest, AGapInThePosesLosesOnlyThePicturesInIt) {
  LiveSource source(usual());
  source.addPose(pose(0, 0));
  source.addPose(pose(1000, 10));
  for (int i = 0; i <= 10; ++i) {
    source.addColor(ms(100 * i), color(i));
    source.addDepth(ms(100 * i), depth(1));
  }
  source.close();
  const auto seen = takeAll(source);
  ASSERT_EQ(seen.size(), 2u);  // at the poses themselves
  EXPECT_EQ(seen[1].time.us, 1'000'000);
  EXPECT_TRUE(source.hasEnded());
  EXPECT_EQ(source.troubles(), "9 pictures without a pose");
}

TEST(LiveSourceTest, WhatIsLateTwiceOrOfAnotherSizeIsCounted) {
  LiveSource source(usual());
  source.addPose(pose(100, 0));
  source.addDepth(ms(100), depth(1));
  source.addColor(ms(100), color(1));
  source.addColor(ms(90), color(2));
  source.addColor(ms(100), color(2));
  source.addColor(ms(200), color(3));
  source.addColor(ms(200), color(4));
  source.addColor(ms(300), cv::Mat(3, 3, CV_8UC3));
  source.addDepth(ms(300), cv::Mat(3, 3, CV_32FC1));
  EXPECT_EQ(takeAll(source).size(), 1u);
  EXPECT_EQ(
      source.troubles(),
      "1 depth pictures not of the camera's size, 1 pictures not of the camera's size, 1 pictures of a time "
      "that was there, 2 pictures that came after later ones had been taken");
}

TEST(LiveSourceTest, WithoutDepthTheFloorIsFlat) {
  LiveOptions options = usual();
  options.altitude_m = 3;
  LiveSource source(options);
  source.addColor(ms(0), color(1));
  source.addPose(pose(0, 0));  // half a turn about x: looks down
  ASSERT_TRUE(source.ready());
  EXPECT_FLOAT_EQ(source.next()->depth_m.at<float>(2, 3), 3.0f);
}

TEST(LiveSourceTest, PosesAreTheBodysAndTheCameraIsMountedOnIt) {
  LiveOptions options = usual();
  options.camera.body_from_camera.translation() = Eigen::Vector3d(0, 0, 2);
  LiveSource source(options);
  source.addDepth(ms(0), depth(1));
  source.addColor(ms(0), color(1));
  source.addPose(pose(0, 5));  // the body's z points down
  EXPECT_TRUE(source.next()->world_from_camera.translation().isApprox(Eigen::Vector3d(5, 0, 7), 1e-12));
}

TEST(LiveSourceTest, EndsAfterSoManyObservations) {
  LiveOptions options = usual();
  options.max_observations = 2;
  LiveSource source(options);
  EXPECT_EQ(source.numObservations(), 2);
  for (int i = 0; i < 4; ++i) {
    source.addPose(pose(100 * i, i));
    source.addDepth(ms(100 * i), depth(1));
    source.addColor(ms(100 * i), color(i));
  }
  EXPECT_EQ(takeAll(source).size(), 2u);
  EXPECT_TRUE(source.hasEnded());
  EXPECT_TRUE(source.ready());
}

TEST(LiveSourceTest, WhoCannotKeepUpSeesThePresent) {
  LiveOptions options = usual();
  options.max_ready = 2;
  LiveSource source(options);
  for (int i = 0; i < 5; ++i) {
    source.addPose(pose(100 * i, i));
    source.addDepth(ms(100 * i), depth(1));
    source.addColor(ms(100 * i), color(i));
  }
  const auto seen = takeAll(source);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].color.at<cv::Vec3b>(0, 0)[0], 3);
  EXPECT_EQ(seen[0].number, 0);
  EXPECT_EQ(source.troubles(), "3 observations, for they came faster than they were learnt from");
}

TEST(LiveSourceTest, PicturesCloserThanThePeriodArePassedOver) {
  LiveOptions options = usual();
  options.min_period_s = 0.25;
  LiveSource source(options);
  for (int i = 0; i < 10; ++i) {
    source.addPose(pose(100 * i, i));
    source.addDepth(ms(100 * i), depth(1));
    source.addColor(ms(100 * i), color(i));
  }
  std::vector<int64_t> times;
  for (const Observation& seen : takeAll(source)) times.push_back(seen.time.us / 1000);
  EXPECT_EQ(times, (std::vector<int64_t>{0, 300, 600, 900}));
  EXPECT_EQ(source.troubles(), "");
}

TEST(LiveSourceTest, MissionTimeMayBeginAtAGivenTime) {
  LiveOptions options = usual();
  options.start = ms(150);
  LiveSource source(options);
  for (int i = 0; i < 4; ++i) {
    source.addPose(pose(100 * i, i));
    source.addDepth(ms(100 * i), depth(1));
    source.addColor(ms(100 * i), color(i));
  }
  const auto seen = takeAll(source);
  ASSERT_EQ(seen.size(), 2u);
  EXPECT_EQ(seen[0].time.us, 50'000);
  EXPECT_EQ(source.troubles(), "2 pictures from before the mission's start");
}

TEST(LiveSourceTest, RefusesOptionsOutOfRange) {
  const auto with = [](const std::function<void(LiveOptions&)>& change) {
    LiveOptions options = usual();
    change(options);
    return options;
  };
  EXPECT_THROW(LiveSource(with([](auto& o) { o.max_waiting = 0; })), std::invalid_argument);
  EXPECT_THROW(LiveSource(with([](auto& o) { o.max_ready = 0; })), std::invalid_argument);
  EXPECT_THROW(LiveSource(with([](auto& o) { o.altitude_m = -1; })), std::invalid_argument);
  EXPECT_THROW(LiveSource(with([](auto& o) { o.min_period_s = -1; })), std::invalid_argument);
}

// Whatever jitter messages have, as long as none is later than a few pictures' time, what comes out is what
// an orderly stream gives: same pictures, same depths, same poses.
TEST(LiveSourceTest, JitterDoesNotMatter) {
  struct Message {
    double arrives;
    std::function<void(LiveSource&)> say;
  };
  const auto fly = [](uint64_t seed, double jitter_ms) {
    Random random(seed);
    const auto jitter = [&] { return jitter_ms * static_cast<double>(random.below(1000)) / 1000.0; };
    std::vector<Message> messages;
    for (int i = 0; i < 60; ++i) {
      const int64_t shot = 100 * i + 3;
      messages.push_back(
          {static_cast<double>(shot) + jitter(), [=](LiveSource& s) { s.addColor(ms(shot), color(i)); }});
      const int64_t range = shot + (i * 7) % 21 - 10;  // the depth camera's own clock
      messages.push_back({static_cast<double>(range) + jitter(),
                          [=](LiveSource& s) { s.addDepth(ms(range), depth(1 + i)); }});
    }
    // Poses end their delays in order, as a sender's queue does.
    double last = 0;
    for (int i = 0; i < 610; ++i) {
      last = std::max(last, 10.0 * i + jitter());
      messages.push_back({last, [=](LiveSource& s) { s.addPose(pose(10 * i, 0.1 * i)); }});
    }
    std::ranges::stable_sort(messages, {}, &Message::arrives);
    LiveSource source(usual());
    std::vector<Observation> seen;
    for (const Message& message : messages) {
      message.say(source);
      while (auto next = source.next()) seen.push_back(std::move(*next));
    }
    source.close();
    while (auto next = source.next()) seen.push_back(std::move(*next));
    EXPECT_EQ(source.troubles(), "") << "seed " << seed;
    return seen;
  };
  const auto orderly = fly(0, 0);
  ASSERT_EQ(orderly.size(), 60u);
  for (uint64_t seed = 1; seed <= 20; ++seed) {
    const auto jittered = fly(seed, 95.0);  // less than from a picture to the next, so that those keep order
    ASSERT_EQ(jittered.size(), orderly.size()) << seed;
    for (size_t i = 0; i < orderly.size(); ++i) {
      ASSERT_EQ(jittered[i].time, orderly[i].time) << seed;
      ASSERT_EQ(jittered[i].color.at<cv::Vec3b>(0, 0), orderly[i].color.at<cv::Vec3b>(0, 0)) << seed;
      ASSERT_EQ(jittered[i].depth_m.at<float>(0, 0), orderly[i].depth_m.at<float>(0, 0)) << seed << ' ' << i;
      ASSERT_TRUE(jittered[i].world_from_camera.isApprox(orderly[i].world_from_camera, 0.0)) << seed;
    }
  }
}

}  // namespace
}  // namespace shoal::world
