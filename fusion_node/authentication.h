// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "shoal/comms/authenticated_bus.h"
#include "shoal/comms/bus.h"
#include "shoal/mapping/queries.h"

namespace shoal::fusion_node {

/// The key of `--key FILE`; nothing when no file is named.
/// @throws std::invalid_argument as comms::SealKey::read().
std::optional<comms::SealKey> readKey(const std::string& file);

/// What a process with a key speaks and listens through: a bus on top of `air`, which outlives it; nothing
/// without a key, so that `air` itself serves.
std::unique_ptr<comms::AuthenticatedBus> authenticated(comms::Bus& air,
                                                       const std::optional<comms::SealKey>& key);

/// Whether these bytes are a message with a seal behind it, whoever made it.
bool isSealed(const comms::Packet& packet);

/// Who speaks without our key, for people.
std::vector<mapping::StrangerStatus> strangersOf(const comms::AuthenticatedBus& bus);

/// Logs what the key let pass, and who has another or none; nothing without a key.
void logAuthentication(const comms::AuthenticatedBus* bus);

}  // namespace shoal::fusion_node
