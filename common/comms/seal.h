// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "shoal/comms/packet.h"

namespace shoal::comms {

/// What stands behind the bytes of a sealed message: session (4), counter (4), tag (8), big-endian.
inline constexpr size_t kSealBytes = 16;

/// A secret that a team shares. Whoever holds it can seal messages under any name of the team.
class SealKey {
 public:
  static constexpr size_t kBytes = 32;

  explicit SealKey(const std::array<uint8_t, kBytes>& secret);
  ~SealKey();  // leaves nothing in memory
  SealKey(const SealKey&) = default;
  SealKey& operator=(const SealKey&) = default;

  /// Reads a key file: the text "shoal-key-1 " and 64 hexadecimal digits, on one line.
  /// @throws std::invalid_argument naming the file when it cannot be read, is no key file, or can be read by
  ///         others than its owner, who must be this user or root. The key itself is in no message.
  static SealKey read(const std::string& path);

  /// Makes a key from the kernel's random numbers and writes it to a new file that only this user can read.
  /// @throws std::invalid_argument when the file exists, std::runtime_error when it cannot be written.
  static SealKey make(const std::string& path);

  /// Eight hexadecimal digits that tell keys apart and say nothing about them.
  std::string id() const;

  /// Keyed BLAKE2b-128 (personal "Shoal seal 1") over: the channel's length in a byte, the channel, session,
  /// counter, message; its first eight bytes. Cost: about 2 us for 1400 bytes.
  std::array<uint8_t, 8> tag(std::string_view channel, uint32_t session, uint32_t counter,
                             std::span<const uint8_t> message) const;

 private:
  std::array<uint8_t, kBytes> secret_;
};

struct Seal {
  uint32_t session = 0;  ///< drawn at random by each process that sends
  uint32_t counter = 0;  ///< 0, 1, ... within the session
};

/// Appends a seal to the message's bytes.
void addSeal(const SealKey& key, const Seal& seal, Packet& packet);

/// The seal at the end of the message's bytes, when its tag is right.
[[nodiscard]] std::optional<Seal> checkSeal(const SealKey& key, const Packet& packet);

/// Moves the last kSealBytes from the bytes to the trailer.
void removeSeal(Packet& packet);

}  // namespace shoal::comms
