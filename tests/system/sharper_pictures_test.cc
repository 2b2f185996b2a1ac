// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/sharper_pictures.h"

#include <gtest/gtest.h>

#include "fusion_node/repair.h"
#include "shoal/mapping/held_pictures.h"
#include "shoal/wire/picture_pieces.h"

namespace shoal::robot_agent {
namespace {

using world::RobotId;

// A robot with pictures of two topics, both said.
class SharperPicturesTest : public testing::Test {
 protected:
  SharperPicturesTest() {
    belief_.robot = RobotId{3};
    belief_.version = {kEpoch, 20};
    for (const int32_t topic : {0, 1}) {
      mapping::ExamplePicture example{
          .topic = world::TopicId{topic}, .observation = 10 + topic, .cell = {}, .seen = {}, .rgb = {}};
      for (int i = 0; i < mapping::ExamplePicture::kEdge * mapping::ExamplePicture::kEdge * 3; ++i)
        example.rgb.push_back(static_cast<uint8_t>(i * (7 + topic) % 251));
      say(wire::picturePieces(example, belief_.robot, kEpoch));
      belief_.examples.push_back(std::move(example));
    }
  }
  void say(const std::vector<mapping::Piece>& pieces) {
    for (const mapping::Piece& piece : pieces) said_.apply(piece);
  }
  static mapping::PieceKey sharperOf(int32_t topic) {
    return {RobotId{3}, mapping::PieceKind::kPicture, {topic, mapping::kSharperBy, 0}};
  }
  void want(int32_t topic) { pictures_.want(fusion_node::nameOf(sharperOf(topic), 0).second); }
  std::vector<mapping::Piece> made() { return pictures_.made(belief_, said_, kEpoch); }

  static constexpr int32_t kEpoch = 2;
  mapping::LocalBelief belief_;
  mapping::BeliefStore said_;
  SharperPictures pictures_;
};

TEST_F(SharperPicturesTest, MakesThatWhichIsWantedOnce) {
  EXPECT_TRUE(made().empty());
  want(1);
  const std::vector<mapping::Piece> layers = made();
  EXPECT_EQ(layers, wire::sharperPieces(belief_.examples[1], RobotId{3}, kEpoch));
  EXPECT_TRUE(made().empty());
  say(layers);
  want(1);
  EXPECT_TRUE(made().empty()) << "it was said, and can be repaired";
}

TEST_F(SharperPicturesTest, WaitsForThePlainPictureToBeSaid) {
  belief_.examples[0].observation = 15;  // another picture, which nobody has heard of
  want(0);
  EXPECT_TRUE(made().empty());
}

TEST_F(SharperPicturesTest, AFloodOfWishesTakesNoMemory) {
  for (uint64_t key = 0; key < 2 * SharperPictures::kMostWanted; ++key) pictures_.want(key);
  want(0);
  EXPECT_TRUE(made().empty());
  want(0);  // asked again
  EXPECT_FALSE(made().empty());
}

}  // namespace
}  // namespace shoal::robot_agent
