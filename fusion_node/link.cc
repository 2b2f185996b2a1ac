// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/link.h"

#include <spdlog/spdlog.h>

#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/message_kind.h"

namespace shoal::fusion_node {

std::optional<comms::OnAir> lookAt(const comms::Packet& packet, int32_t mission) {
  const auto header = wire::peek(packet.bytes);
  if (!header || header->mission != mission || header->kind == wire::MessageKind::kMap) return std::nullopt;
  comms::OnAir on_air{header->time.us, {}};
  if (header->kind != wire::MessageKind::kHeartbeat) return on_air;
  const auto heartbeat = wire::decodeHeartbeat(packet.bytes);
  if (heartbeat && heartbeat->phase != wire::Phase::kNode && heartbeat->observation >= 0) {
    on_air.position_m = {heartbeat->x_m, heartbeat->y_m, heartbeat->z_m};
  }
  return on_air;
}

std::unique_ptr<comms::LinkEmulator> emulated(comms::Bus& air, const comms::LinkModel& model,
                                              const LinkOptions& options) {
  comms::check(model);
  if (model.isClean()) return nullptr;
  comms::LinkEmulatorOptions link;
  link.receiver = options.node;
  link.seed = options.seed;
  link.rate = options.rate;
  link.look = [mission = options.mission](const comms::Packet& packet) { return lookAt(packet, mission); };
  return std::make_unique<comms::LinkEmulator>(air, model, std::move(link));
}

void logLink(const comms::LinkEmulator* link) {
  if (link == nullptr) return;
  const comms::LinkCounts& n = link->counts();
  spdlog::info(
      "the link: {} messages of others, {} delivered; lost {}, faded {}, overflowed {}, parted {}, out of "
      "range {}; doubled {}, held back {}",
      n.sent, n.delivered, n.lost, n.faded, n.overflowed, n.parted, n.out_of_range, n.doubled, n.overtaken);
}

}  // namespace shoal::fusion_node
