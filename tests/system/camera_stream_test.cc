// SPDX-License-Identifier: BSD-3-Clause
// What a robot's cameras say on a bus, as observations; messages made by lcm-gen's code.
#include "robot_agent/camera_stream.h"

#include <limits>
#include <thread>

#include <gtest/gtest.h>
#include <zlib.h>
#include <bot_core/images_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <opencv2/imgcodecs.hpp>
#include <shoal/vehicle_t.hpp>

#include "shoal/comms/memory_bus.h"
#include "shoal/wire/camera_pixels.h"

namespace shoal::robot_agent {
namespace {

constexpr int kWidth = 32, kHeight = 24;

world::LiveOptions usual() {
  world::LiveOptions options;
  options.camera.intrinsics = {kWidth, kHeight, 20, 20, 15.5, 11.5};
  return options;
}

template <typename Message>
comms::Bytes encoded(const Message& message) {
  comms::Bytes bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

class CameraStreamTest : public testing::Test {
 protected:
  void say(const std::string& channel, comms::Bytes bytes) { camera_->publish({channel, std::move(bytes)}); }
  void sayPose(int64_t utime, double x) {
    say("CAM_POSE", wire::encode(world::TimedPose{{utime}, {x, 0, 5}, Eigen::Quaterniond(0, 1, 0, 0)}));
  }
  void sayPicture(const std::string& channel, int64_t utime, int type, double value) {
    const cv::Mat picture(kHeight, kWidth, type, cv::Scalar::all(value));
    say(channel, wire::encode(wire::viewOf(picture, {utime})));
  }

  comms::MemoryNetwork network_;
  std::unique_ptr<comms::MemoryBus> camera_ = network_.connect(), robot_ = network_.connect();
};

TEST_F(CameraStreamTest, JoinsColourDepthAndPose) {
  world::LiveOptions options = usual();
  options.camera.depth_factor = 500;
  CameraStream stream(*robot_, "CAM", options, 0);
  EXPECT_FALSE(stream.ready());
  for (int i = 0; i < 3; ++i) {
    sayPose(1000 * i, i);
    sayPicture("CAM_DEPTH", 1000 * i, CV_16UC1, 1000 + i);
    sayPicture("CAM_IMAGE", 1000 * i, CV_8UC3, 10 * i);
    sayPose(1000 * i + 500, i);
  }
  for (int i = 0; i < 3; ++i) {
    ASSERT_TRUE(stream.ready());
    const auto seen = stream.next();
    ASSERT_TRUE(seen);
    EXPECT_EQ(seen->number, i);
    EXPECT_EQ(seen->time.us, 1000 * i);
    EXPECT_EQ(seen->color.at<cv::Vec3b>(0, 0)[1], 10 * i);
    EXPECT_FLOAT_EQ(seen->depth_m.at<float>(0, 0), static_cast<float>((1000 + i) / 500.0));
    EXPECT_EQ(seen->world_from_camera.translation().x(), i);
  }
  EXPECT_FALSE(stream.ready());
  EXPECT_EQ(stream.troubles(), "");
}

TEST_F(CameraStreamTest, TakesAnRgbdCamerasMessageOfOneTime) {
  CameraStream stream(*robot_, "CAM", usual(), 0);
  bot_core::images_t images{};
  images.utime = 5000;
  images.image_types = {bot_core::images_t::LEFT, bot_core::images_t::DEPTH_MM_ZIPPED, 1};
  images.images.resize(3);  // the last is of a right eye, and empty
  images.n_images = 3;
  for (bot_core::image_t& image : images.images) {
    image.width = kWidth;
    image.height = kHeight;
  }
  images.images[0].pixelformat = bot_core::image_t::PIXEL_FORMAT_MJPEG;
  cv::imencode(".jpg", cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(200, 100, 50)), images.images[0].data);
  const cv::Mat depth(kHeight, kWidth, CV_16UC1, cv::Scalar(1234));
  uLongf size = compressBound(kWidth * kHeight * 2);
  images.images[1].data.resize(size);
  ASSERT_EQ(compress(images.images[1].data.data(), &size, depth.ptr<uint8_t>(), kWidth * kHeight * 2), Z_OK);
  images.images[1].data.resize(size);
  for (bot_core::image_t& image : images.images) image.size = static_cast<int32_t>(image.data.size());
  say("CAM_IMAGES", encoded(images));
  bot_core::rigid_transform_t pose{};
  pose.utime = 5000;
  pose.trans[2] = 8;
  pose.quat[1] = 1;
  say("CAM_POSE", encoded(pose));
  ASSERT_TRUE(stream.ready());
  const auto seen = stream.next();
  EXPECT_NEAR(seen->color.at<cv::Vec3b>(5, 5)[0], 200, 3);
  EXPECT_FLOAT_EQ(seen->depth_m.at<float>(5, 5), 1.234f);  // millimetres, whatever the depth camera's unit
  EXPECT_EQ(seen->world_from_camera.translation().z(), 8);
  EXPECT_EQ(stream.troubles(), "");
}

TEST_F(CameraStreamTest, CountsWhatItCannotUse) {
  CameraStream stream(*robot_, "CAM", usual(), 0);
  say("CAM_IMAGE", {1, 2, 3});
  say("CAM_POSE", comms::Bytes(100, 7));
  say("CAM_DEPTH", wire::encode(world::TimedPose{}));
  say("CAM_IMAGES", comms::Bytes(8));
  say("CAM_IMAGE", wire::encode(wire::viewOf(cv::Mat(9, 9, CV_8UC3, cv::Scalar(0)), {0})));
  sayPicture("CAM_IMAGE", 0, CV_16UC1, 1);  // depth on the colour's channel
  say("OTHER_IMAGE", {1, 2, 3});
  EXPECT_FALSE(stream.ready());
  EXPECT_EQ(
      stream.troubles(),
      "1 messages of pictures not of the camera's size, 1 messages refused: too short, 3 messages refused: "
      "wrong type, 1 messages refused: unknown format");
}

TEST_F(CameraStreamTest, KeepsWhatTheVehicleSaidLastOfItself) {
  CameraStream stream(*robot_, "CAM", usual(), 0);
  EXPECT_FALSE(stream.vehicle().battery_percent || stream.vehicle().depth_m);
  shoal::vehicle_t vehicle{};
  const auto told = [&](float battery_percent, float depth_m) {
    vehicle.battery_percent = battery_percent;
    vehicle.depth_m = depth_m;
    say("CAM_STATUS", encoded(vehicle));
    stream.ready();
    return stream.vehicle();
  };
  EXPECT_EQ(told(86.6f, 12.25f).battery_percent, 87);
  EXPECT_EQ(told(86.6f, 12.25f).depth_m, 12.25);
  EXPECT_EQ(told(100, -1).battery_percent, 100);
  EXPECT_FALSE(stream.vehicle().depth_m);
  EXPECT_EQ(told(-1, 0).depth_m, 0.0);
  EXPECT_FALSE(stream.vehicle().battery_percent);
  EXPECT_EQ(stream.troubles(), "");
  constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  for (const auto& [battery, depth] : {std::pair(101.f, 5.f), {kNone, 5.f}, {50.f, kNone}, {50.f, 1e9f}}) {
    EXPECT_EQ(told(battery, depth).depth_m, 0.0);  // what was known stays
  }
  vehicle = {};
  comms::Bytes bytes = encoded(vehicle);
  for (size_t size = 0; size < bytes.size(); ++size) {
    say("CAM_STATUS", comms::Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size)));
  }
  bytes.push_back(0);
  say("CAM_STATUS", bytes);
  vehicle.utime = -1;
  say("CAM_STATUS", encoded(vehicle));
  stream.ready();
  EXPECT_EQ(stream.vehicle().depth_m, 0.0);
  EXPECT_NE(stream.troubles().find("5 messages refused: field out of range"), std::string::npos)
      << stream.troubles();
  EXPECT_NE(stream.troubles().find("1 messages refused: trailing bytes"), std::string::npos)
      << stream.troubles();
}

TEST_F(CameraStreamTest, EndsWhenNoPictureCameForTooLong) {
  world::LiveOptions options = usual();
  options.altitude_m = 2;
  CameraStream stream(*robot_, "CAM", options, 0.05);
  sayPose(0, 0);
  sayPicture("CAM_IMAGE", 0, CV_8UC3, 1);
  sayPicture("CAM_IMAGE", 10'000, CV_8UC3, 2);  // its pose never comes; the one before is near enough
  ASSERT_TRUE(stream.ready());
  EXPECT_TRUE(stream.next());
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  ASSERT_TRUE(stream.ready());
  EXPECT_TRUE(stream.next());
  EXPECT_TRUE(stream.ready());
  EXPECT_FALSE(stream.next());
}

}  // namespace
}  // namespace shoal::robot_agent
