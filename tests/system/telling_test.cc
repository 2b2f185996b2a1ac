// SPDX-License-Identifier: BSD-3-Clause
// What one robot tells, from the Publisher by the CheckpointSaver to the Voice, on a bus in memory.
#include <gtest/gtest.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "robot_agent/checkpoint_saver.h"
#include "robot_agent/publisher.h"
#include "robot_agent/voice.h"
#include "shoal/comms/memory_bus.h"
#include "shoal/mapping/atomic_file.h"

namespace shoal::robot_agent {
namespace {

using mapping::Piece;

constexpr int32_t kMission = 3;
constexpr world::RobotId kRobot{4};

// A topic with so many words, as of an observation.
Piece topic(int32_t observation, int32_t num_words) {
  mapping::TopicPart content{.created = {}, .weight = num_words, .group_sizes = {4000}, .words = {}};
  for (int32_t w = 0; w < num_words; ++w) content.words.push_back({3 * w + w * w % 3, 1 + w * w % 97});
  return {.key = {kRobot, mapping::PieceKind::kTopic, {0, 0, 0}},
          .version = {0, observation},
          .content = std::move(content)};
}

class TellingTest : public testing::Test {
 protected:
  ~TellingTest() override { std::filesystem::remove_all(folder_); }

  std::unique_ptr<CheckpointSaver> saver(const std::string& folder, bool counts_images = false) {
    return std::make_unique<CheckpointSaver>(
        SaverOptions{.folder = folder,
                     .robot = kRobot,
                     .counts_images = counts_images,
                     .retry_after = std::chrono::hours(1)},
        [this] {
          Checkpoint checkpoint;
          checkpoint.mission = kMission;
          checkpoint.robot = kRobot;
          voice_.saveTo(checkpoint);
          return checkpoint;
        },
        voice_);
  }
  void publish(CheckpointSaver& saver, const Piece& piece, bool repeatable) {
    Publisher(kMission, saver, voice_).publish({piece}, repeatable);
  }
  bool isSaid(const Piece& piece) const {
    const Piece* said = voice_.said().find(piece.key, 0);
    return said != nullptr && said->version == piece.version;
  }
  Checkpoint saved() const { return readCheckpoint(checkpointPath(folder_, kRobot)).value_or(Checkpoint{}); }

  const std::string folder_ = testing::TempDir() + "/telling_test." + std::to_string(::getpid());
  comms::MemoryNetwork network_;
  const std::unique_ptr<comms::MemoryBus> bus_ = network_.connect();
  fusion_node::MissionState state_{kMission, {}};
  Voice voice_{{.robot = kRobot, .mission = kMission, .budget = 100}, *bus_, state_};
};

TEST_F(TellingTest, PartsThatAPieceHasNoLongerAreNotSaid) {
  const auto at_once = saver("");
  Publisher publisher(kMission, *at_once, voice_);
  publisher.publish({topic(1, 1300)}, true);
  Piece part = *voice_.said().find(topic(1, 1300).key, 0);
  ASSERT_GT(part.num_parts, 2);
  part.part = part.num_parts - 1;
  EXPECT_TRUE(voice_.isWaiting(part));
  publisher.publish({topic(2, 10)}, true);
  EXPECT_FALSE(voice_.isWaiting(part));
  part.part = 0;
  EXPECT_TRUE(voice_.isWaiting(part));
}

TEST_F(TellingTest, WhatIsSaidTheSameWayAgainIsSaidAtOnce) {
  const auto saves = saver(folder_);
  publish(*saves, topic(1, 10), true);
  EXPECT_TRUE(isSaid(topic(1, 10)));
  EXPECT_EQ(state_.beliefs().digest(), voice_.said().digest());
  EXPECT_FALSE(saves->isHolding());
}

TEST_F(TellingTest, WhatIsNotIsSaidWhenACheckpointHasIt) {
  const auto saves = saver(folder_);
  publish(*saves, topic(1, 10), false);
  EXPECT_FALSE(isSaid(topic(1, 10)));
  EXPECT_TRUE(saves->isHolding());
  saves->save();
  publish(*saves, topic(2, 10), false);  // too late for that checkpoint
  saves->wait();
  EXPECT_TRUE(isSaid(topic(1, 10)));
  while (saves->isHolding()) saves->wait();  // another one was begun at once
  EXPECT_TRUE(isSaid(topic(2, 10)));
  const Checkpoint checkpoint = saved();
  ASSERT_EQ(checkpoint.said.size(), 2u);
  EXPECT_EQ(checkpoint.said[1].piece, topic(2, 10));
  EXPECT_TRUE(checkpoint.said[1].waits);
}

TEST_F(TellingTest, InALiveFlightImagesSayWhenToSave) {
  const auto saves = saver(folder_, true);
  publish(*saves, topic(1, 10), false);
  saves->look();
  EXPECT_FALSE(saves->isSaving());
  saves->landed();
  saves->look();
  saves->wait();
  EXPECT_TRUE(isSaid(topic(1, 10)));
}

// A file stands where the folder should be: as on a full disk nothing can be written.
TEST_F(TellingTest, WhatCannotBeSavedWaitsAndTheRestIsSaid) {
  mapping::writeFileAtomically(folder_, "in the way");
  const auto saves = saver(folder_);
  publish(*saves, topic(1, 10), false);
  saves->save();
  publish(*saves, topic(2, 10), false);  // newer than what is being saved
  saves->wait();
  EXPECT_FALSE(saves->isSaving());
  EXPECT_TRUE(saves->isHolding());
  saves->look();  // not tried again at once
  EXPECT_FALSE(saves->isSaving());
  Piece other = topic(1, 20);
  other.key.index[0] = 1;
  publish(*saves, other, true);
  EXPECT_TRUE(isSaid(other));
  saves->finish();  // once more, in vain
  EXPECT_TRUE(saves->isHolding());
  EXPECT_FALSE(isSaid(topic(1, 10)) || isSaid(topic(2, 10)));

  std::filesystem::remove(folder_);
  saves->save();
  saves->wait();
  EXPECT_TRUE(isSaid(topic(2, 10)));
  EXPECT_FALSE(saves->isHolding());
  EXPECT_EQ(saved().said.size(), 2u);
  EXPECT_TRUE(std::filesystem::exists(epochPath(folder_, kRobot)));
}

TEST_F(TellingTest, ADiskThatFailedIsTriedAgainByItself) {
  mapping::writeFileAtomically(folder_, "in the way");
  CheckpointSaver saves(
      {.folder = folder_, .robot = kRobot, .retry_after = {}}, [] { return Checkpoint(); }, voice_);
  publish(saves, topic(1, 10), false);
  saves.save();
  saves.wait();
  std::filesystem::remove(folder_);
  saves.look();
  saves.wait();
  EXPECT_TRUE(isSaid(topic(1, 10)));
}

TEST_F(TellingTest, WhereNothingIsSavedNothingIsHeld) {
  const auto saves = saver("");
  publish(*saves, topic(1, 10), false);
  EXPECT_TRUE(isSaid(topic(1, 10)));
  saves->save();
  EXPECT_FALSE(saves->isSaving());
}

TEST_F(TellingTest, WhatIsForgottenIsNotSaidWhenItIsSaved) {
  const auto saves = saver(folder_);
  publish(*saves, topic(1, 10), false);
  saves->forget(topic(1, 10).key, 0);
  EXPECT_FALSE(saves->isHolding());
  saves->save();
  saves->wait();
  EXPECT_FALSE(isSaid(topic(1, 10)));
}

// A version that is said again must be the same bytes, in the same parts.
TEST_F(TellingTest, AfterACrashPiecesAreCutAsBefore) {
  const auto saves = saver(folder_);
  saves->save();
  saves->wait();
  for (const int64_t budget : {0, 20'000}) {
    Voice later({.robot = kRobot, .mission = kMission, .budget = budget}, *bus_, state_);
    ASSERT_NE(later.mostBytes(topic(1, 10)), voice_.mostBytes(topic(1, 10)));
    later.restore(saved());
    EXPECT_EQ(later.mostBytes(topic(1, 10)), voice_.mostBytes(topic(1, 10)));
    Checkpoint again;
    later.saveTo(again);
    EXPECT_EQ(again.cut.budget, 100);
  }
}

TEST_F(TellingTest, ACheckpointSaysWhenItWasSavedByBothClocks) {
  Checkpoint written;
  written.saved = {.wall_us = 12, .boot_us = 7, .boot_id = "0c4a-one"};
  writeCheckpoint(checkpointPath(folder_, kRobot), written);
  EXPECT_EQ(saved().saved.wall_us, 12);
  EXPECT_EQ(saved().saved.boot_us, 7);
  EXPECT_EQ(saved().saved.boot_id, "0c4a-one");
}

TEST_F(TellingTest, AfterACrashNoPictureIsSaidAgain) {
  Piece picture{.key = {kRobot, mapping::PieceKind::kPicture, {0, 0, 0}},
                .version = {0, 5},
                .content = mapping::PicturePart{}};
  Checkpoint checkpoint;
  checkpoint.said.push_back({picture, false, {}});
  voice_.restore(checkpoint);
  const auto saves = saver("");
  Publisher publisher(kMission, *saves, voice_);
  publisher.restore(checkpoint);
  publisher.publishPictures({picture}, true);  // a robot that comes back finds all of them new
  EXPECT_FALSE(voice_.isWaiting(picture));
  picture.version.observation = 6;
  publisher.publishPictures({picture}, true);
  EXPECT_TRUE(voice_.isWaiting(picture));
}

TEST_F(TellingTest, AfterACrashWhatWaitedIsSaidAgain) {
  Checkpoint checkpoint;
  checkpoint.said.push_back({topic(1, 10), true, {}});
  Piece other = topic(1, 20);
  other.key.index[0] = 1;
  checkpoint.said.push_back({other, false, {}});
  voice_.restore(checkpoint);
  EXPECT_TRUE(isSaid(topic(1, 10)) && isSaid(other));
  EXPECT_TRUE(voice_.isWaiting(topic(1, 10)));
  EXPECT_FALSE(voice_.isWaiting(other));
}

}  // namespace
}  // namespace shoal::robot_agent
