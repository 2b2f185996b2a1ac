// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/channels.h"

#include "shoal/comms/camera_channels.h"

#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

namespace shoal::comms {
namespace {

TEST(ChannelsTest, ComposesAndParsesBack) {
  EXPECT_EQ(channelName("R03", "TOPICS"), "SHOAL_R03_TOPICS");
  for (const char* node : {"R00", "OPERATOR", "7", "ABCDEFGHIJ012345"}) {
    for (const char* kind : {"A", "HEARTBEAT"}) {
      EXPECT_EQ(parseChannel(channelName(node, kind)), (ChannelName{node, kind}));
    }
  }
  const std::string longest(63 - 6 - 16 - 1, 'K');
  EXPECT_EQ(channelName("ABCDEFGHIJ012345", longest).size(), kMaxChannelLength);
}

TEST(ChannelsTest, RejectsOtherNames) {
  for (const char* channel :
       {"", "SHOAL", "SHOAL_", "SHOAL_R03", "SHOAL_R03_", "SHOAL__TOPICS", "SHOAL_r03_TOPICS",
        "SHOAL_R03_TOPICS2", "SHOAL_R03_TOPICS_", "SHOAL_R0_3_TOPICS", "shoal_R03_TOPICS",
        "XSHOAL_R03_TOPICS", "LCM_SELF_TEST", "SHOAL_R03_TOP\nICS", "SHOAL_ABCDEFGHIJ0123456_TOPICS",
        "SHOAL_R03_T\xc3\x84"}) {
    EXPECT_EQ(parseChannel(channel), std::nullopt) << channel;
  }
  EXPECT_EQ(parseChannel(std::string("SHOAL_R03_A") + '\0'), std::nullopt);
  EXPECT_EQ(parseChannel("SHOAL_R03_" + std::string(54, 'K')), std::nullopt);  // 64 characters
}

TEST(ChannelsTest, RefusesToComposeThem) {
  EXPECT_THROW(channelName("r03", "TOPICS"), std::invalid_argument);
  EXPECT_THROW(channelName("", "TOPICS"), std::invalid_argument);
  EXPECT_THROW(channelName("ABCDEFGHIJ0123456", "TOPICS"), std::invalid_argument);
  EXPECT_THROW(channelName("R03", ""), std::invalid_argument);
  EXPECT_THROW(channelName("R03", "TOPICS_2"), std::invalid_argument);
  EXPECT_THROW(channelName("R03", std::string(54, 'K')), std::invalid_argument);
}

TEST(CameraChannelsTest, AreThePrefixAndWhatTheyCarry) {
  const CameraChannels channels("AUV2_front");
  EXPECT_EQ(channels.image, "AUV2_front_IMAGE");
  EXPECT_EQ(channels.depth, "AUV2_front_DEPTH");
  EXPECT_EQ(channels.images, "AUV2_front_IMAGES");
  EXPECT_EQ(channels.pose, "AUV2_front_POSE");
  for (const std::string& bad : {std::string(), std::string("CAM 1"), std::string("CAM.*"),
                                 std::string("SHOAL_R00"), std::string(57, 'A')}) {
    EXPECT_THROW(CameraChannels{bad}, std::invalid_argument) << bad;
  }
  EXPECT_EQ(CameraChannels(std::string(56, 'A')).images.size(), 63u);
}

}  // namespace
}  // namespace shoal::comms
