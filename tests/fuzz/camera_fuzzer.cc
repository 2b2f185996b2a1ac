// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as a camera's message: every decoder returns, and pixels only come out in the size that was said.
// The first byte picks the type, whose fingerprint is put right, so that the fuzzer gets past it.
//
//     fuzz_camera -max_total_time=60 -max_len=4096
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <opencv2/core/utils/logger.hpp>

#include "shoal/wire/camera_codec.h"
#include "shoal/wire/camera_pixels.h"

namespace {

using namespace shoal::wire;  // NOLINT: a main file

void look(const ImageView& image) {
  if (image.width > 512 || image.height > 512) return;  // so that a run is quick
  for (const auto& picture : {colorFrom(image), depthFrom(image), unzippedDepthFrom(image)}) {
    if (picture && picture->size() != cv::Size(image.width, image.height)) std::abort();
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const bool quiet = [] {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    return true;
  }();
  if (!quiet || size < 9) return 0;
  Bytes bytes(data + 1, data + size);
  constexpr int kTypes = 5;
  const int64_t fingerprints[kTypes] = {imageFingerprint(), imagesFingerprint(), poseFingerprint(),
                                        rigidTransformFingerprint(), vehicleFingerprint()};
  const auto fingerprint = static_cast<uint64_t>(fingerprints[data[0] % kTypes]);
  for (size_t i = 0; i < 8; ++i) bytes[i] = static_cast<uint8_t>(fingerprint >> (56 - 8 * i));
  if (const auto image = decodeImage(bytes)) look(*image);
  if (const auto images = decodeImages(bytes)) {
    for (const KindAndImage& each : *images) look(each.image);
  }
  if (const auto pose = decodePose(bytes); pose && !pose->isSane()) std::abort();
  if (const auto vehicle = decodeVehicle(bytes)) {
    const auto within = [](double value, double most) { return value >= 0 && value <= most; };
    if (!within(vehicle->battery_percent.value_or(0), 100) || !within(vehicle->depth_m.value_or(0), 20000))
      std::abort();
  }
  return 0;
}
