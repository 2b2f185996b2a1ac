// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <string>

#include "shoal/comms/bus.h"
#include "shoal/comms/camera_channels.h"
#include "shoal/wire/camera_codec.h"
#include "shoal/world/live_source.h"

namespace shoal::robot_agent {

/// A real robot's cameras and localisation on a bus, as a source of observations: what comes is decoded and
/// handed to a LiveSource. What cannot be decoded is counted by reason.
class CameraStream final : public world::ObservationSource {
 public:
  /// @param bus        on the camera's channels; outlives the stream.
  /// @param timeout_s  wall seconds without a picture after which the stream ends; 0 = it never does.
  /// @throws std::invalid_argument as LiveSource() and CameraChannels().
  CameraStream(comms::Bus& bus, const std::string& prefix, const world::LiveOptions& options,
               double timeout_s);

  /// Takes in what has come. Warns of what cannot be used, every half minute while it becomes more.
  bool ready() override;
  /// Nothing unless ready().
  std::optional<world::Observation> next() override { return live_.next(); }
  std::optional<int32_t> numObservations() const override { return live_.numObservations(); }
  std::string troubles() const override;
  world::Vehicle vehicle() const override { return vehicle_; }

 private:
  using Clock = std::chrono::steady_clock;
  void take(const comms::Packet& packet);
  void takeColor(const wire::ImageView& image);
  void takeDepth(const wire::ImageView& image, bool zipped, double units_per_metre);
  bool hasCamerasSize(const wire::ImageView& image);
  void warn();
  void refuse(wire::DecodeError error) { ++refused_[static_cast<size_t>(error)]; }

  comms::Bus& bus_;
  const comms::CameraChannels channels_;
  const world::Camera camera_;
  const double timeout_s_;
  world::LiveSource live_;
  std::array<uint64_t, wire::kNumDecodeErrors> refused_{};
  uint64_t other_size_ = 0;
  world::Vehicle vehicle_;
  Clock::time_point last_picture_;
  std::string warned_of_;
  Clock::time_point warned_at_;
};

}  // namespace shoal::robot_agent
