// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/authenticated_bus.h"

#include <sodium.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "shoal/comms/channels.h"
#include "shoal/demand.h"

namespace shoal::comms {

AuthenticatedBus::AuthenticatedBus(Bus& air, const SealKey& key, IsWhole is_whole)
    : air_(air), key_(key), is_whole_(std::move(is_whole)) {
  SHOAL_DEMAND(is_whole_ != nullptr);
  beginSession();
}

// A counter never comes twice in a session: a restarted process has another one, however its clock stands.
void AuthenticatedBus::beginSession() { own_ = {randombytes_random(), 0}; }

void AuthenticatedBus::publish(const Packet& packet) {
  Packet sealed{packet.channel, packet.bytes};
  addSeal(key_, own_, sealed);
  if (own_.counter == std::numeric_limits<uint32_t>::max()) {
    beginSession();
  } else {
    ++own_.counter;
  }
  air_.publish(sealed);
}

int AuthenticatedBus::receive(int timeout_ms, const std::function<void(const Packet&)>& handler) {
  int delivered = 0;
  air_.receive(timeout_ms, [&](const Packet& heard) {
    if (!accept(heard)) return;
    Packet packet = heard;
    removeSeal(packet);
    ++delivered;
    handler(packet);
  });
  return delivered;
}

bool AuthenticatedBus::accept(const Packet& packet) {
  const auto seal = checkSeal(key_, packet);
  if (!seal) {
    meetStranger(packet);
    return false;
  }
  const auto channel = parseChannel(packet.channel);
  if (!channel || !isNew(channel->node, *seal)) {
    refuse(counts_.replayed, "replayed");
    return false;
  }
  ++counts_.accepted;
  return true;
}

bool AuthenticatedBus::isNew(const std::string& node, const Seal& seal) {
  const auto key = std::pair(node, seal.session);
  if (!sessions_.contains(key) && sessions_.size() >= kMaxSessions) {
    sessions_.erase(std::ranges::min_element(sessions_, {},
                                             [](const auto& session) { return session.second.last_heard; }));
  }
  Session& session = sessions_[key];
  session.last_heard = counts_.accepted;
  return session.window.take(seal.counter);
}

void AuthenticatedBus::meetStranger(const Packet& packet) {
  const bool has_a_seal = !is_whole_(packet.bytes);
  refuse(has_a_seal ? counts_.other_key : counts_.no_key, has_a_seal ? "not of our key" : "without a key");
  const auto channel = parseChannel(packet.channel);
  if (!channel || (!strangers_.contains(channel->node) && strangers_.size() >= kMaxStrangers)) return;
  Stranger& stranger = strangers_[channel->node];
  ++stranger.messages;
  stranger.has_a_seal = has_a_seal;
}

void AuthenticatedBus::countInto(Stats& stats) {
  stats_ = &stats;
  air_.countInto(stats);
}

void AuthenticatedBus::refuse(uint64_t& count, std::string_view reason) {
  ++count;
  if (stats_ != nullptr) stats_->countRejected(reason);
}

}  // namespace shoal::comms
