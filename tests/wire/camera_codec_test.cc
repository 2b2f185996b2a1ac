// SPDX-License-Identifier: BSD-3-Clause
// What a robot's cameras say, encoded by lcm-gen's code and read by ours.
#include "shoal/wire/camera_codec.h"

#include <cmath>
#include <limits>
#include <string>

#include <gtest/gtest.h>
#include <zlib.h>
#include <bot_core/images_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <opencv2/imgcodecs.hpp>

#include "shoal/random.h"
#include "shoal/wire/camera_pixels.h"
#include "shoal/wire/limits.h"

namespace shoal::wire {
namespace {

template <typename Message>
Bytes encoded(const Message& message) {
  Bytes bytes(static_cast<size_t>(message.getEncodedSize()));
  message.encode(bytes.data(), 0, static_cast<int>(bytes.size()));
  return bytes;
}

void setInt32(Bytes& bytes, size_t at, uint32_t value) {
  for (size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<uint8_t>(value >> (24 - 8 * i));
}

// Offsets in an image_t: fingerprint 8, utime 8, width, height, row_stride, pixelformat, size: 4 each.
constexpr size_t kUtime = 8, kWidth = 16, kHeight = 20, kStride = 24, kFormat = 28, kSize = 32, kData = 36;

bot_core::image_t rgb3x2() {
  bot_core::image_t image{};
  image.utime = 1'234'567'890'123'456;
  image.width = 3;
  image.height = 2;
  image.row_stride = 10;  // a byte of padding
  image.pixelformat = bot_core::image_t::PIXEL_FORMAT_RGB;
  for (uint8_t i = 0; i < 20; ++i) image.data.push_back(i);
  image.size = 20;
  image.nmetadata = 2;
  image.metadata.resize(2);
  image.metadata[0].key = "exposure";
  image.metadata[0].value = {1, 2, 3};
  image.metadata[0].n = 3;
  image.metadata[1].n = 0;
  return image;
}

TEST(CameraCodecTest, FormatsAreTheEcosystemsNumbers) {
  EXPECT_EQ(static_cast<int32_t>(PixelFormat::kRgb), bot_core::image_t::PIXEL_FORMAT_RGB);
  EXPECT_EQ(static_cast<int32_t>(PixelFormat::kBgr), bot_core::image_t::PIXEL_FORMAT_BGR);
  EXPECT_EQ(static_cast<int32_t>(PixelFormat::kGray), bot_core::image_t::PIXEL_FORMAT_GRAY);
  EXPECT_EQ(static_cast<int32_t>(PixelFormat::kMjpeg), bot_core::image_t::PIXEL_FORMAT_MJPEG);
  EXPECT_EQ(static_cast<int32_t>(PixelFormat::kGray16), bot_core::image_t::PIXEL_FORMAT_LE_GRAY16);
  EXPECT_EQ(static_cast<int16_t>(ImageKind::kDepthMm), bot_core::images_t::DEPTH_MM);
  EXPECT_EQ(static_cast<int16_t>(ImageKind::kDepthMmZipped), bot_core::images_t::DEPTH_MM_ZIPPED);
}

TEST(CameraCodecTest, ReadsAnImage) {
  const Bytes bytes = encoded(rgb3x2());
  const auto image = decodeImage(bytes);
  ASSERT_TRUE(image.ok()) << name(image.error());
  EXPECT_EQ(image->time.us, 1'234'567'890'123'456);
  EXPECT_EQ(image->width, 3);
  EXPECT_EQ(image->height, 2);
  EXPECT_EQ(image->row_stride, 10);
  EXPECT_EQ(image->data.size(), 20u);
  const auto color = colorFrom(*image);
  ASSERT_TRUE(color.ok());
  EXPECT_EQ(color->at<cv::Vec3b>(0, 0), cv::Vec3b(2, 1, 0));
  EXPECT_EQ(color->at<cv::Vec3b>(1, 2), cv::Vec3b(18, 17, 16));  // row 1 begins at byte 10
}

TEST(CameraCodecTest, ReadsEveryColourFormat) {
  bot_core::image_t image = rgb3x2();
  image.pixelformat = bot_core::image_t::PIXEL_FORMAT_BGR;
  Bytes bytes = encoded(image);
  EXPECT_EQ((*colorFrom(*decodeImage(bytes))).at<cv::Vec3b>(0, 1), cv::Vec3b(3, 4, 5));
  image.pixelformat = bot_core::image_t::PIXEL_FORMAT_GRAY;
  bytes = encoded(image);
  EXPECT_EQ((*colorFrom(*decodeImage(bytes))).at<cv::Vec3b>(1, 1), cv::Vec3b::all(11));
  image.row_stride = 0;  // said by some: rows without gaps
  bytes = encoded(image);
  EXPECT_EQ((*colorFrom(*decodeImage(bytes))).at<cv::Vec3b>(1, 1), cv::Vec3b::all(4));
  image.pixelformat = 1498831189;  // UYVY
  bytes = encoded(image);
  EXPECT_EQ(colorFrom(*decodeImage(bytes)).error(), DecodeError::kUnknownFormat);
  EXPECT_EQ(depthFrom(*decodeImage(bytes)).error(), DecodeError::kUnknownFormat);
}

TEST(CameraCodecTest, ReadsAJpegOfExactlyTheSaidSize) {
  cv::Mat picture(48, 64, CV_8UC3, cv::Scalar(200, 100, 50));
  bot_core::image_t image{};
  image.width = 64;
  image.height = 48;
  image.pixelformat = bot_core::image_t::PIXEL_FORMAT_MJPEG;
  cv::imencode(".jpg", picture, image.data);
  image.size = static_cast<int32_t>(image.data.size());
  Bytes bytes = encoded(image);
  const auto color = colorFrom(*decodeImage(bytes));
  ASSERT_TRUE(color.ok());
  EXPECT_NEAR(color->at<cv::Vec3b>(20, 20)[0], 200, 3);
  EXPECT_NEAR(color->at<cv::Vec3b>(20, 20)[2], 50, 3);
  setInt32(bytes, kWidth, 63);
  EXPECT_EQ(colorFrom(*decodeImage(bytes)).error(), DecodeError::kBadPayload);
  for (size_t cut = 0; cut < image.data.size();
       cut += 7) {  // cut short: refused or grey below, never a crash
    bot_core::image_t shorter = image;
    shorter.data.resize(cut);
    shorter.size = static_cast<int32_t>(cut);
    bytes = encoded(shorter);
    const auto seen = colorFrom(*decodeImage(bytes));
    if (seen) {
      EXPECT_EQ(seen->size(), cv::Size(64, 48));
    }
  }
}

TEST(CameraCodecTest, ReadsColourAndDepthOfOneTime) {
  bot_core::images_t images{};
  images.utime = 777;
  images.image_types = {bot_core::images_t::LEFT, bot_core::images_t::DEPTH_MM,
                        bot_core::images_t::DEPTH_MM_ZIPPED};
  images.images.resize(3);
  images.n_images = 3;
  images.images[0] = rgb3x2();
  bot_core::image_t& depth = images.images[1];
  depth.width = 2;
  depth.height = 2;
  depth.row_stride = 4;
  depth.pixelformat = bot_core::image_t::PIXEL_FORMAT_LE_GRAY16;
  depth.data = {1, 0, 2, 0, 0, 1, 255, 255};
  depth.size = 8;
  images.images[2] = depth;
  uLongf packed = compressBound(8);
  images.images[2].data.resize(packed);
  ASSERT_EQ(compress(images.images[2].data.data(), &packed, depth.data.data(), 8), Z_OK);
  images.images[2].data.resize(packed);
  images.images[2].size = static_cast<int32_t>(packed);
  const Bytes bytes = encoded(images);
  const auto read = decodeImages(bytes);
  ASSERT_TRUE(read.ok()) << name(read.error());
  ASSERT_EQ(read->size(), 3u);
  EXPECT_EQ((*read)[0].image.time.us, 777);  // of the whole, not the picture's own
  const auto plain = depthFrom((*read)[1].image), unzipped = unzippedDepthFrom((*read)[2].image);
  ASSERT_TRUE(plain.ok() && unzipped.ok());
  for (const cv::Mat& each : {*plain, *unzipped}) {
    EXPECT_EQ(each.at<uint16_t>(0, 0), 1);
    EXPECT_EQ(each.at<uint16_t>(0, 1), 2);
    EXPECT_EQ(each.at<uint16_t>(1, 0), 256);
    EXPECT_EQ(each.at<uint16_t>(1, 1), 65535);
  }
  // Truncated anywhere: refused.
  for (size_t size = 0; size < bytes.size(); ++size) {
    EXPECT_FALSE(decodeImages(std::span(bytes).first(size)).ok()) << size;
  }
  EXPECT_EQ(decodeImage(bytes).error(), DecodeError::kWrongType);
}

TEST(CameraCodecTest, ReadsBothKindsOfPose) {
  bot_core::pose_t pose{};
  pose.utime = 42;
  const double pos[] = {1, 2, 3}, orientation[] = {0.8, 0.6, 0, 0};
  std::copy_n(pos, 3, pose.pos);
  std::copy_n(orientation, 4, pose.orientation);
  pose.vel[0] = pose.accel[2] = pose.rotation_rate[1] = 99;
  bot_core::rigid_transform_t transform{};
  transform.utime = 42;
  std::copy_n(pos, 3, transform.trans);
  std::copy_n(orientation, 4, transform.quat);
  for (const Bytes& bytes : {encoded(pose), encoded(transform)}) {
    const auto read = decodePose(bytes);
    ASSERT_TRUE(read.ok()) << name(read.error());
    EXPECT_EQ(read->time.us, 42);
    EXPECT_EQ(read->position, Eigen::Vector3d(1, 2, 3));
    EXPECT_EQ(read->orientation.w(), 0.8);
    EXPECT_EQ(read->orientation.x(), 0.6);
    for (size_t size = 0; size < bytes.size(); ++size)
      EXPECT_FALSE(decodePose(std::span(bytes).first(size)).ok()) << size;
    Bytes longer = bytes;
    longer.push_back(0);
    EXPECT_EQ(decodePose(longer).error(), DecodeError::kTrailingBytes);
  }
  pose.pos[1] = std::nan("");
  EXPECT_EQ(decodePose(encoded(pose)).error(), DecodeError::kBadField);
  pose.pos[1] = 0;
  pose.orientation[0] = 0;
  EXPECT_EQ(decodePose(encoded(pose)).error(), DecodeError::kBadField);
  pose.orientation[0] = 0.8;
  pose.utime = -1;
  EXPECT_EQ(decodePose(encoded(pose)).error(), DecodeError::kBadField);
}

TEST(CameraCodecTest, WhatWeEncodeLcmGensDecoderReads) {
  cv::Mat picture(2, 3, CV_16UC1);
  for (int i = 0; i < 6; ++i) picture.at<uint16_t>(i / 3, i % 3) = static_cast<uint16_t>(300 * i);
  const Bytes bytes = encode(viewOf(picture, {55}));
  bot_core::image_t message{};
  ASSERT_EQ(message.decode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  EXPECT_EQ(message.utime, 55);
  EXPECT_EQ(message.width, 3);
  EXPECT_EQ(message.row_stride, 6);
  EXPECT_EQ(message.pixelformat, bot_core::image_t::PIXEL_FORMAT_LE_GRAY16);
  EXPECT_EQ(message.data[10] + 256 * message.data[11], 1500);
  const world::TimedPose pose{{66}, {1.5, -2, 1e-3}, Eigen::Quaterniond(0.1, 0.7, -0.7, 0.1)};
  const auto back = decodePose(encode(pose));
  ASSERT_TRUE(back.ok());
  EXPECT_EQ(back->position, pose.position);
  EXPECT_EQ(back->orientation.coeffs(), pose.orientation.coeffs());
}

TEST(CameraCodecTest, EveryTruncationIsRefused) {
  const Bytes bytes = encoded(rgb3x2());
  for (size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(decodeImage(std::span(bytes).first(size)).ok()) << size;
}

TEST(CameraCodecTest, CraftedLengthsAreRefusedByReason) {
  const auto crafted = [](auto change) {
    Bytes bytes = encoded(rgb3x2());
    change(bytes);
    const auto read = decodeImage(bytes);
    return read ? "accepted" : std::string(name(read.error()));
  };
  EXPECT_EQ(crafted([](Bytes&) {}), "accepted");
  EXPECT_EQ(crafted([](Bytes& b) { b[0] ^= 1; }), "wrong type");
  EXPECT_EQ(crafted([](Bytes& b) { b.push_back(0); }), "trailing bytes");
  EXPECT_EQ(crafted([](Bytes& b) { b.resize(kMaxCameraBytes + 1); }), "too long");
  EXPECT_EQ(crafted([](Bytes& b) { b[kUtime] = 0x80; }), "field out of range");
  for (const uint32_t bad : {0u, 0xffffffffu, 0x80000000u, 8193u, 100'000'000u}) {
    EXPECT_EQ(crafted([&](Bytes& b) { setInt32(b, kWidth, bad); }), "field out of range") << bad;
    EXPECT_EQ(crafted([&](Bytes& b) { setInt32(b, kHeight, bad); }), "field out of range") << bad;
  }
  EXPECT_EQ(crafted([](Bytes& b) { setInt32(b, kStride, 0xffffffff); }), "field out of range");
  for (const uint32_t bad : {0xffffffffu, 0x80000000u, 0x7fffffffu, 300'000'000u, 200u})
    EXPECT_EQ(crafted([&](Bytes& b) { setInt32(b, kSize, bad); }), "bad length") << bad;
  const size_t count = kData + 20;  // nmetadata
  for (const uint32_t bad : {0xffffffffu, 0x7fffffffu, 257u})
    EXPECT_EQ(crafted([&](Bytes& b) { setInt32(b, count, bad); }), "field out of range") << bad;
  EXPECT_EQ(crafted([&](Bytes& b) { setInt32(b, count, 3); }), "bad length");
  EXPECT_EQ(crafted([&](Bytes& b) { setInt32(b, count + 4, 0xffffffff); }), "bad length");  // a key's length
}

// Good lengths around pixels that do not fill the picture.
TEST(CameraCodecTest, PixelsThatDoNotFillThePictureAreRefused) {
  Bytes bytes = encoded(rgb3x2());
  setInt32(bytes, kHeight, 3);
  EXPECT_EQ(colorFrom(*decodeImage(bytes)).error(), DecodeError::kBadPayload);
  bytes = encoded(rgb3x2());
  setInt32(bytes, kStride, 0x7fffffff);
  EXPECT_EQ(colorFrom(*decodeImage(bytes)).error(), DecodeError::kBadPayload);
  bytes = encoded(rgb3x2());
  setInt32(bytes, kStride, 8);  // less than a row
  EXPECT_EQ(colorFrom(*decodeImage(bytes)).error(), DecodeError::kBadPayload);
  bytes = encoded(rgb3x2());
  setInt32(bytes, kWidth, 8192);
  setInt32(bytes, kHeight, 8192);
  setInt32(bytes, kFormat, static_cast<uint32_t>(PixelFormat::kMjpeg));
  EXPECT_EQ(colorFrom(*decodeImage(bytes)).error(), DecodeError::kBadPayload);
  EXPECT_EQ(unzippedDepthFrom(*decodeImage(bytes)).error(), DecodeError::kBadPayload);
}

// Rubbish behind each fingerprint: returns, and what it returns lies within the message.
TEST(CameraCodecTest, RandomBytesAreRefusedOrAreAValue) {
  Random random(11);
  const Bytes good = encoded(rgb3x2());
  for (int trial = 0; trial < 20000; ++trial) {
    Bytes bytes = good;
    const size_t changes = 1 + random.below(6);
    for (size_t i = 0; i < changes; ++i)
      bytes[8 + random.below(bytes.size() - 8)] = static_cast<uint8_t>(random());
    bytes.resize(8 + random.below(bytes.size()), 0);
    const auto image = decodeImage(bytes);
    if (!image) continue;
    EXPECT_LE(image->data.size(), bytes.size());
    (void)colorFrom(*image);
    (void)depthFrom(*image);
  }
}

}  // namespace
}  // namespace shoal::wire
