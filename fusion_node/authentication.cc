// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/authentication.h"

#include <span>

#include <spdlog/spdlog.h>

#include "shoal/wire/limits.h"
#include "shoal/wire/message_kind.h"

namespace shoal::fusion_node {

static_assert(comms::kSealBytes == wire::kSealRoom);

std::optional<comms::SealKey> readKey(const std::string& file) {
  if (file.empty()) return std::nullopt;
  return comms::SealKey::read(file);
}

std::unique_ptr<comms::AuthenticatedBus> authenticated(comms::Bus& air,
                                                       const std::optional<comms::SealKey>& key) {
  if (!key) return nullptr;
  spdlog::info("messages are sealed with key {}", key->id());
  const auto is_whole = [](std::span<const uint8_t> bytes) {
    const auto behind = wire::bytesBehind(bytes);
    return behind && *behind == 0;
  };
  return std::make_unique<comms::AuthenticatedBus>(air, *key, is_whole);
}

bool isSealed(const comms::Packet& packet) {
  const auto behind = wire::bytesBehind(packet.bytes);
  return behind && *behind == comms::kSealBytes;
}

std::vector<mapping::StrangerStatus> strangersOf(const comms::AuthenticatedBus& bus) {
  std::vector<mapping::StrangerStatus> strangers;
  for (const auto& [name, stranger] : bus.strangers()) {
    strangers.push_back({name, stranger.has_a_seal ? "other key" : "no key", stranger.messages});
  }
  return strangers;
}

void logAuthentication(const comms::AuthenticatedBus* bus) {
  if (bus == nullptr) return;
  const comms::AuthenticationCounts& n = bus->counts();
  spdlog::info("the key: {} messages accepted, {} without a key, {} not of this key, {} replayed", n.accepted,
               n.no_key, n.other_key, n.replayed);
  for (const mapping::StrangerStatus& stranger : strangersOf(*bus))
    spdlog::warn("{} is a stranger: {}, {} messages", stranger.name, stranger.has, stranger.messages);
}

}  // namespace shoal::fusion_node
