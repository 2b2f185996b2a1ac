// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/camera_codec.h"

#include <bit>
#include <cmath>
#include <stdexcept>
#include <string>

#include <bot_core/image_t.hpp>
#include <bot_core/images_t.hpp>
#include <bot_core/pose_t.hpp>
#include <bot_core/rigid_transform_t.hpp>
#include <shoal/vehicle_t.hpp>

#include "shoal/demand.h"
#include "shoal/wire/limits.h"

namespace shoal::wire {
namespace {

int64_t int64From(ByteReader& in) { return static_cast<int64_t>(in.bigEndian(8)); }
int32_t int32From(ByteReader& in) { return static_cast<int32_t>(in.bigEndian(4)); }
int16_t int16From(ByteReader& in) { return static_cast<int16_t>(in.bigEndian(2)); }
double doubleFrom(ByteReader& in) { return std::bit_cast<double>(in.bigEndian(8)); }

constexpr float kDeepest = 20000.f;  // metres

/// What every decoder begins with.
Result<int64_t> fingerprintOf(std::span<const uint8_t> bytes) {
  if (bytes.size() > kMaxCameraBytes) return DecodeError::kTooLong;
  if (bytes.size() < 8) return DecodeError::kTooShort;
  return static_cast<int64_t>(bigEndian(bytes.first(8)));
}

/// A length, and as many bytes.
std::span<const uint8_t> takeCounted(ByteReader& in) {
  const int32_t size = int32From(in);
  return in.take(size < 0 ? UINT64_MAX : static_cast<uint64_t>(size));
}

/// The members of an image_t; the time is not judged.
Result<ImageView> takeImage(ByteReader& in) {
  ImageView image;
  image.time.us = int64From(in);
  image.width = int32From(in);
  image.height = int32From(in);
  image.row_stride = int32From(in);
  image.pixel_format = int32From(in);
  image.data = takeCounted(in);
  const int32_t num_metadata = int32From(in);
  if (in.failed()) return DecodeError::kBadLength;
  if (num_metadata < 0 || num_metadata > kMaxImageMetadata) return DecodeError::kBadField;
  for (int32_t i = 0; i < 2 * num_metadata; ++i) takeCounted(in);  // key, value
  if (in.failed()) return DecodeError::kBadLength;
  const auto side = [](int32_t pixels) { return pixels >= 1 && pixels <= kMaxImageSide; };
  if (!side(image.width) || !side(image.height) || image.row_stride < 0) return DecodeError::kBadField;
  return image;
}

}  // namespace

int64_t imageFingerprint() { return bot_core::image_t::getHash(); }
int64_t imagesFingerprint() { return bot_core::images_t::getHash(); }
int64_t poseFingerprint() { return bot_core::pose_t::getHash(); }
int64_t rigidTransformFingerprint() { return bot_core::rigid_transform_t::getHash(); }
int64_t vehicleFingerprint() { return vehicle_t::getHash(); }

Result<ImageView> decodeImage(std::span<const uint8_t> bytes) {
  const auto fingerprint = fingerprintOf(bytes);
  if (!fingerprint) return fingerprint.error();
  if (*fingerprint != imageFingerprint()) return DecodeError::kWrongType;
  ByteReader in(bytes.subspan(8));
  const auto image = takeImage(in);
  if (!image) return image.error();
  if (in.remaining() > 0) return DecodeError::kTrailingBytes;
  if (!isTime(image->time)) return DecodeError::kBadField;
  return *image;
}

Result<std::vector<KindAndImage>> decodeImages(std::span<const uint8_t> bytes) {
  const auto fingerprint = fingerprintOf(bytes);
  if (!fingerprint) return fingerprint.error();
  if (*fingerprint != imagesFingerprint()) return DecodeError::kWrongType;
  ByteReader in(bytes.subspan(8));
  const world::Timestamp time{int64From(in)};
  const int32_t num_images = int32From(in);
  if (in.failed()) return DecodeError::kTooShort;
  if (!isTime(time) || num_images < 0 || num_images > kMaxImagesPerMessage) return DecodeError::kBadField;
  std::vector<KindAndImage> images(static_cast<size_t>(num_images));
  for (KindAndImage& each : images) each.kind = int16From(in);
  for (KindAndImage& each : images) {
    const auto image = takeImage(in);
    if (!image) return image.error();
    each.image = *image;
    each.image.time = time;
  }
  if (in.failed()) return DecodeError::kTooShort;
  if (in.remaining() > 0) return DecodeError::kTrailingBytes;
  return images;
}

Result<world::TimedPose> decodePose(std::span<const uint8_t> bytes) {
  const auto fingerprint = fingerprintOf(bytes);
  if (!fingerprint) return fingerprint.error();
  const bool is_pose = *fingerprint == poseFingerprint();
  if (!is_pose && *fingerprint != rigidTransformFingerprint()) return DecodeError::kWrongType;
  ByteReader in(bytes.subspan(8));
  world::TimedPose pose;
  pose.time.us = int64From(in);
  for (int i = 0; i < 3; ++i) pose.position[i] = doubleFrom(in);
  if (is_pose) in.take(3 * 8);  // vel
  const double w = doubleFrom(in), x = doubleFrom(in), y = doubleFrom(in), z = doubleFrom(in);
  pose.orientation = Eigen::Quaterniond(w, x, y, z);
  if (is_pose) in.take(2 * 3 * 8);  // rotation_rate, accel
  if (in.failed()) return DecodeError::kTooShort;
  if (in.remaining() > 0) return DecodeError::kTrailingBytes;
  if (!isTime(pose.time) || !pose.isSane()) return DecodeError::kBadField;
  return pose;
}

namespace {

template <typename Message>
Bytes encoded(const Message& message) {
  const int size = message.getEncodedSize();
  Bytes bytes(static_cast<size_t>(size));
  SHOAL_DEMAND(message.encode(bytes.data(), 0, size) == size);
  return bytes;
}

}  // namespace

Result<world::Vehicle> decodeVehicle(std::span<const uint8_t> bytes) {
  const auto fingerprint = fingerprintOf(bytes);
  if (!fingerprint) return fingerprint.error();
  if (*fingerprint != vehicleFingerprint()) return DecodeError::kWrongType;
  ByteReader in(bytes.subspan(8));
  const int64_t time_us = int64From(in);
  const float battery = std::bit_cast<float>(static_cast<uint32_t>(in.bigEndian(4)));
  const float depth = std::bit_cast<float>(static_cast<uint32_t>(in.bigEndian(4)));
  if (in.failed()) return DecodeError::kBadLength;
  if (in.remaining() > 0) return DecodeError::kTrailingBytes;
  if (!isTime({time_us}) || !(battery <= 100.f) || !(depth <= kDeepest)) return DecodeError::kBadField;
  world::Vehicle vehicle;
  if (battery >= 0) vehicle.battery_percent = static_cast<int32_t>(std::lround(battery));
  if (depth >= 0) vehicle.depth_m = depth;
  return vehicle;
}

Bytes encode(const ImageView& image) {
  if (image.data.size() + 64 > kMaxCameraBytes) {
    throw std::invalid_argument("a picture of " + std::to_string(image.data.size()) +
                                " bytes is more than a message can hold, " + std::to_string(kMaxCameraBytes));
  }
  bot_core::image_t message{};
  message.utime = image.time.us;
  message.width = image.width;
  message.height = image.height;
  message.row_stride = image.row_stride;
  message.pixelformat = image.pixel_format;
  message.size = static_cast<int32_t>(image.data.size());
  message.data.assign(image.data.begin(), image.data.end());
  message.nmetadata = 0;
  return encoded(message);
}

Bytes encode(const world::TimedPose& pose) {
  bot_core::pose_t message{};
  message.utime = pose.time.us;
  for (int i = 0; i < 3; ++i) message.pos[i] = pose.position[i];
  const Eigen::Quaterniond& q = pose.orientation;
  message.orientation[0] = q.w();
  message.orientation[1] = q.x();
  message.orientation[2] = q.y();
  message.orientation[3] = q.z();
  return encoded(message);
}

}  // namespace shoal::wire
