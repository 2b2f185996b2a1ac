// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shoal/wire/bytes.h"
#include "shoal/wire/result.h"
#include "shoal/world/ids.h"
#include "shoal/world/pose_track.h"
#include "shoal/world/source.h"

namespace shoal::wire {

// What the cameras of real robots say, in the LCM ecosystem's types (bot_core): lcmtypes/bot_core_*.lcm,
// docs/cameras.md. The decoders are our own, for those that lcm-gen makes allocate what a length says before
// they look whether it is there: here every length is checked against the bytes received, and pixels are seen
// in place.

/// No camera message is longer: LCM itself puts at most 16 MB of fragments together.
inline constexpr size_t kMaxCameraBytes = size_t{16} << 20;
inline constexpr int32_t kMaxImageSide = 8192;
inline constexpr int32_t kMaxImagesPerMessage = 16;
inline constexpr int32_t kMaxImageMetadata = 256;

/// image_t::pixelformat, those that we read.
enum class PixelFormat : int32_t {
  kGray = 1497715271,
  kRgb = 859981650,
  kBgr = 861030210,
  kMjpeg = 1196444237,
  kGray16 = 909199180  ///< 16 bits, the least significant byte first
};

/// images_t::image_types, those that we read.
enum class ImageKind : int16_t { kLeft = 0, kDepthMm = 4, kDepthMmZipped = 6 };

/// One picture, its pixels still in the message's bytes, which must outlive it.
struct ImageView {
  world::Timestamp time;
  int32_t width = 0, height = 0;  ///< pixels, in [1, kMaxImageSide]
  int32_t row_stride = 0;         ///< bytes from a row to the next, >= 0; 0 = as many as a row has
  int32_t pixel_format = 0;
  std::span<const uint8_t> data;
};

struct KindAndImage {
  int16_t kind = 0;
  ImageView image;  ///< at the time of the whole message
};

/// Reads an image_t. Times lie in [0, kMaxTimeUs], as everywhere; metadata is passed over.
Result<ImageView> decodeImage(std::span<const uint8_t> bytes);

/// Reads an images_t.
Result<std::vector<KindAndImage>> decodeImages(std::span<const uint8_t> bytes);

/// Reads a pose_t or a rigid_transform_t; the pose is sane.
Result<world::TimedPose> decodePose(std::span<const uint8_t> bytes);

/// Reads a vehicle_t, one of our own types: what is not known is nothing. Numbers out of range are refused.
Result<world::Vehicle> decodeVehicle(std::span<const uint8_t> bytes);

/// Writes an image_t without metadata. @throws std::invalid_argument above kMaxCameraBytes.
Bytes encode(const ImageView& image);

/// Writes a pose_t that stands still.
Bytes encode(const world::TimedPose& pose);

/// Which type a message says it is, for what may come as either.
int64_t imageFingerprint();
int64_t imagesFingerprint();
int64_t poseFingerprint();
int64_t rigidTransformFingerprint();
int64_t vehicleFingerprint();

}  // namespace shoal::wire
