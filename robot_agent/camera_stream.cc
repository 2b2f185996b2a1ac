// SPDX-License-Identifier: BSD-3-Clause
#include "robot_agent/camera_stream.h"

#include <stdexcept>

#include <spdlog/spdlog.h>

#include "shoal/wire/camera_pixels.h"
#include "shoal/world/recording.h"

namespace shoal::robot_agent {
namespace {

constexpr double kMillimetres = 1000.0;
constexpr std::chrono::seconds kWarnEvery{30};

}  // namespace

CameraStream::CameraStream(comms::Bus& bus, const std::string& prefix, const world::LiveOptions& options,
                           double timeout_s)
    : bus_(bus),
      channels_(prefix),
      camera_(options.camera),
      timeout_s_(timeout_s),
      live_(options),
      last_picture_(Clock::now()),
      warned_at_(Clock::now() - kWarnEvery) {}

bool CameraStream::ready() {
  bus_.receive(0, [this](const comms::Packet& packet) { take(packet); });
  warn();
  const std::chrono::duration<double> silence = Clock::now() - last_picture_;
  if (timeout_s_ > 0 && silence.count() > timeout_s_) live_.close();
  return live_.ready();
}

void CameraStream::warn() {
  if (Clock::now() - warned_at_ < kWarnEvery) return;
  warned_at_ = Clock::now();
  const std::string now = troubles();
  if (now != warned_of_) spdlog::warn("left out so far: {}", now);
  warned_of_ = now;
}

std::string CameraStream::troubles() const {
  std::string text = live_.troubles();
  const auto add = [&text](uint64_t count, const std::string& what) {
    if (count > 0) text += (text.empty() ? "" : ", ") + std::to_string(count) + " " + what;
  };
  add(other_size_, "messages of pictures not of the camera's size");
  for (size_t i = 0; i < refused_.size(); ++i) {
    add(refused_[i], "messages refused: " + std::string(wire::kDecodeErrorNames[i]));
  }
  return text;
}

void CameraStream::take(const comms::Packet& packet) {
  if (packet.channel == channels_.pose) {
    const auto pose = wire::decodePose(packet.bytes);
    pose ? live_.addPose(*pose) : refuse(pose.error());
  } else if (packet.channel == channels_.vehicle) {
    const auto vehicle = wire::decodeVehicle(packet.bytes);
    vehicle ? void(vehicle_ = *vehicle) : refuse(vehicle.error());
  } else if (packet.channel == channels_.image) {
    const auto image = wire::decodeImage(packet.bytes);
    image ? takeColor(*image) : refuse(image.error());
  } else if (packet.channel == channels_.depth) {
    const auto image = wire::decodeImage(packet.bytes);
    image ? takeDepth(*image, false, camera_.depth_factor.value_or(kMillimetres)) : refuse(image.error());
  } else if (packet.channel == channels_.images) {
    const auto images = wire::decodeImages(packet.bytes);
    if (!images) return refuse(images.error());
    for (const auto& [kind, image] : *images) {
      wire::ImageView depth = image;  // whatever format it is said to have, its kind says what it is
      depth.pixel_format = static_cast<int32_t>(wire::PixelFormat::kGray16);
      switch (static_cast<wire::ImageKind>(kind)) {
        case wire::ImageKind::kLeft:
          takeColor(image);
          break;
        case wire::ImageKind::kDepthMm:
          takeDepth(depth, false, kMillimetres);
          break;
        case wire::ImageKind::kDepthMmZipped:
          takeDepth(depth, true, kMillimetres);
          break;
      }  // others, as of a second eye, are not for us
    }
  }
}

// Before pixels are decoded, for that is what costs.
bool CameraStream::hasCamerasSize(const wire::ImageView& image) {
  const bool same = image.width == camera_.intrinsics.width && image.height == camera_.intrinsics.height;
  if (!same) ++other_size_;
  return same;
}

void CameraStream::takeColor(const wire::ImageView& image) {
  if (!hasCamerasSize(image)) return;
  const auto color = wire::colorFrom(image);
  if (!color) return refuse(color.error());
  last_picture_ = Clock::now();
  live_.addColor(image.time, *color);
}

void CameraStream::takeDepth(const wire::ImageView& image, bool zipped, double units_per_metre) {
  if (!hasCamerasSize(image)) return;
  const auto raw = zipped ? wire::unzippedDepthFrom(image) : wire::depthFrom(image);
  if (!raw) return refuse(raw.error());
  world::Camera camera = camera_;
  camera.depth_factor = units_per_metre;
  live_.addDepth(image.time, world::depthInMetres(*raw, camera));
}

}  // namespace shoal::robot_agent
