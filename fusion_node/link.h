// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "shoal/comms/bus.h"
#include "shoal/comms/link_emulator.h"
#include "shoal/comms/link_model.h"

namespace shoal::fusion_node {

/// Who listens to an emulated link.
struct LinkOptions {
  std::string node;
  int32_t mission = 1;
  uint64_t seed = 1;  ///< of the mission
  double rate = 1.0;  ///< seconds of mission time per wall second, 0 = as fast as possible
};

/// How an emulated link sees the messages of a mission: when they were sent, and of robots' heartbeats, where
/// from. Nothing for rubbish, for other missions and for whole maps, which are said to their own host alone.
std::optional<comms::OnAir> lookAt(const comms::Packet& packet, int32_t mission);

/// What a process listens to under `--link`: the link on top of `air`, which outlives it; nothing when the
/// link is clean, so that `air` itself serves.
/// @throws std::invalid_argument when the model is out of range.
std::unique_ptr<comms::LinkEmulator> emulated(comms::Bus& air, const comms::LinkModel& model,
                                              const LinkOptions& options);

/// Logs what the link did; nothing when there is none.
void logLink(const comms::LinkEmulator* link);

}  // namespace shoal::fusion_node
