// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "shoal/comms/bus.h"
#include "shoal/comms/replay_window.h"
#include "shoal/comms/seal.h"
#include "shoal/comms/stats.h"

namespace shoal::comms {

/// What AuthenticatedBus did with what it heard.
struct AuthenticationCounts {
  uint64_t accepted = 0;
  uint64_t no_key = 0;     ///< whole messages without a seal
  uint64_t other_key = 0;  ///< no seal of our key: another key's, forged or altered
  uint64_t replayed = 0;   ///< a right seal that was seen before, or is too old to tell
};

/// A name under which something was said that our key did not seal.
struct Stranger {
  uint64_t messages = 0;
  bool has_a_seal = false;  ///< of the last message: of another key, or altered; else none at all
};

/// A bus whose messages carry a seal of a shared key: adds it to what is published, checks and removes it
/// from what is heard, and delivers nothing else. Own messages are heard too, as everywhere.
///
/// Protects against those without the key: they cannot say, alter or repeat anything. A process that has just
/// begun accepts, once, what was said before it began. What a sender says under a new session after a restart
/// is new to all. Nothing is hidden: whoever listens can read. Those who hold the key trust each other.
class AuthenticatedBus final : public Bus {
 public:
  /// Says whether bytes are a whole message without a seal: only to tell strangers without a key from those
  /// with another.
  using IsWhole = std::function<bool(std::span<const uint8_t>)>;

  /// At most so many strangers and so many sessions of others are remembered; of more sessions the one that
  /// was heard least recently is forgotten.
  static constexpr size_t kMaxStrangers = 64;
  static constexpr size_t kMaxSessions = 4096;

  /// `air` outlives it.
  AuthenticatedBus(Bus& air, const SealKey& key, IsWhole is_whole);

  void publish(const Packet& packet) override;

  /// Returns the number delivered, which may be 0 although something was heard.
  int receive(int timeout_ms, const std::function<void(const Packet&)>& handler) override;

  size_t trailerBytes() const override { return air_.trailerBytes() + kSealBytes; }

  const AuthenticationCounts& counts() const { return counts_; }

  /// By the names of the channels they used.
  const std::map<std::string, Stranger>& strangers() const { return strangers_; }

  void countInto(Stats& stats) override;

 private:
  struct Session {
    ReplayWindow window;
    uint64_t last_heard = 0;  // by number of messages
  };

  bool accept(const Packet& packet);
  bool isNew(const std::string& node, const Seal& seal);
  void meetStranger(const Packet& packet);
  void refuse(uint64_t& count, std::string_view reason);
  void beginSession();

  Bus& air_;
  SealKey key_;
  IsWhole is_whole_;
  Seal own_;
  AuthenticationCounts counts_;
  std::map<std::pair<std::string, uint32_t>, Session> sessions_;  // by node and session
  std::map<std::string, Stranger> strangers_;
  Stats* stats_ = nullptr;
};

}  // namespace shoal::comms
