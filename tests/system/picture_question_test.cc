// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/picture_question.h"

#include <cmath>
#include <nlohmann/json.hpp>

#include <gtest/gtest.h>

#include "shoal/random.h"
#include "shoal/wire/picture_pieces.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::fusion_node {
namespace {

using Json = nlohmann::ordered_json;

// A robot whose picture of a topic, of noise, was heard.
class PictureQuestionTest : public testing::Test {
 protected:
  PictureQuestionTest() {
    mapping::ExamplePicture example{
        .topic = world::TopicId{7}, .observation = 3, .cell = {}, .seen = {}, .rgb = {}};
    Random noise(1);
    for (int i = 0; i < mapping::ExamplePicture::kEdge * mapping::ExamplePicture::kEdge * 3; ++i)
      example.rgb.push_back(static_cast<uint8_t>(noise.below(256)));
    for (const mapping::Piece& piece : wire::picturePieces(example, world::RobotId{3}, 0))
      hear({"SHOAL_R03_PICTURE", wire::encode(piece, kMission, {})});
  }
  void hear(const comms::Packet& packet) { state_.hear(packet, stats_); }
  void beat(int64_t second, wire::Phase phase) {
    wire::Heartbeat h;
    h.mission = kMission;
    h.time = {second * 1'000'000};
    h.observation = 10;
    h.phase = phase;
    h.budget = 500;
    h.queue_bytes = 3000;
    hear({"SHOAL_R03_HEARTBEAT", wire::encode(h)});
  }
  Json price() const {
    const Json question{{"robot", "R03"}, {"topic", 7}};
    return priceOf(state_, sharperPicture(state_, question), "OPERATOR", 1000);
  }

  static constexpr int32_t kMission = 5;
  MissionState state_{kMission, {}};
  comms::Stats stats_;
};

TEST_F(PictureQuestionTest, TheTimeToClearIsTheBacklogByWhatTheBudgetCarries) {
  wire::Heartbeat h;
  h.queue_bytes = 5000;
  EXPECT_EQ(statusOf("R03", h, true, {}).clear_s, 0);  // without a budget nothing waits long
  h.budget = 2000;
  EXPECT_NEAR(statusOf("R03", h, true, {}).clear_s, 5000 / (1000. - 200), 1e-9);
  h.budget = 10'000;  // seven full datagrams a second
  EXPECT_NEAR(statusOf("R03", h, true, {}).clear_s, 5000 / (8750. - 1000), 1e-9);
}

TEST_F(PictureQuestionTest, ThereIsABoundOnTheTimeOnceARobotHasNothingNewToTell) {
  EXPECT_EQ(price()["state"], "not sharp");
  EXPECT_TRUE(price()["seconds"].is_null());
  EXPECT_TRUE(price()["heard_ago_s"].is_null());
  beat(20, wire::Phase::kFlying);
  EXPECT_TRUE(price()["seconds"].is_null());
  EXPECT_EQ(price()["heard_ago_s"], 0.0);
  beat(30, wire::Phase::kListening);
  EXPECT_TRUE(price()["seconds"].is_null());
  beat(40, wire::Phase::kLanded);
  // One full datagram fits a second of these budgets: windows carry half of them, of which heartbeats take a
  // fifth.
  const double request = price()["bytes"]["request"], answer = price()["bytes"]["answer"];
  EXPECT_NEAR(price()["seconds"], request / 400 + (3000 + answer) / 200, 0.1);
}

}  // namespace
}  // namespace shoal::fusion_node
