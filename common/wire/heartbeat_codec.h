// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shoal/wire/bytes.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/result.h"
#include "shoal/world/ids.h"

namespace shoal::wire {

/// What a node is doing. The numbers are part of the wire format.
enum class Phase : uint8_t {
  kFlying = 0,
  kLanded = 1,    ///< its source has ended, and it has told what it makes of it
  kLeaving = 2,   ///< about to end in good order
  kNode = 3,      ///< a fusion node: flies nothing
  kListening = 4  ///< its source has ended; it will look at its map again when all of the team have landed
};

/// A robot whose source has ended: what it has learnt changes no more.
constexpr bool hasLanded(Phase phase) {
  return phase == Phase::kLanded || phase == Phase::kLeaving || phase == Phase::kListening;
}

/// How a node is doing, as it says about once a second. Its channel says who it is.
struct Heartbeat {
  /// What a fusing node holds of one robot: equal digests, nothing to repair.
  struct Share {
    world::RobotId robot{};
    uint32_t digest = 0;  ///< shareDigest() of what it holds
    bool operator==(const Share&) const = default;
  };
  static constexpr size_t kNumClasses = 7;

  world::Timestamp time;         ///< mission time of sending, in [0, kMaxTimeUs]
  int32_t mission = 0;           ///< mission id
  int32_t epoch = 0;             ///< >= 0
  int32_t observation = -1;      ///< number of the latest one; -1: none yet
  int32_t num_observations = 0;  ///< planned; 0: not known
  Phase phase = Phase::kFlying;
  int32_t num_topics = 0;           ///< own topics alive, in [0, 10000]
  int32_t num_cells = 0;            ///< own cells, or those of the fused map; >= 0
  uint64_t own_digest = 0;          ///< of the sender's own pieces; 0: a pure fusion node
  uint64_t state_digest = 0;        ///< of all the state it holds
  uint64_t map_digest = 0;          ///< of its fused map; 0: it does not fuse
  uint64_t map_of_state = 0;        ///< state digest the map was made from; 0: it does not fuse
  uint64_t vocabulary = 0;          ///< fingerprint of the visual vocabulary
  double cell_size_m = 1;           ///< edge of a map cell, finite, > 0
  int32_t host = 0;                 ///< hash of the host's name
  int32_t pid = 0;                  ///< process id, >= 0
  float x_m = 0, y_m = 0, z_m = 0;  ///< position in the world frame, finite
  int64_t bytes_sent = 0;           ///< on the link, all headers counted, >= 0
  int32_t budget = 0;               ///< bytes/s of mission time, >= 0; 0: unlimited
  int32_t queue_bytes = 0;          ///< waiting to be sent, >= 0
  int32_t rejected = 0;             ///< messages refused, >= 0
  int32_t conflicts = 0;            ///< same version, other content, >= 0
  float ms_per_frame = 0;           ///< mean wall time per observation, finite, >= 0
  std::array<int64_t, kNumClasses> class_bytes{};  ///< bytes_sent by traffic class, each >= 0
  int32_t battery_percent = -1;                    ///< of its vehicle, in [0, 100]; -1: not known
  int32_t depth_cm = -1;                           ///< of its vehicle below the surface, >= 0; -1: not known
  uint32_t learnt = 0;        ///< shareDigest() of its own topics and settings; 0 of who has not landed
  std::vector<Share> roster;  ///< ascending by robot; at most kMaxRoster
  bool operator==(const Heartbeat&) const = default;
};

/// The 32 bits of a robot's digest that travel in rosters.
constexpr uint32_t shareDigest(uint64_t digest) { return static_cast<uint32_t>(digest ^ digest >> 32); }

/// A heartbeat as heartbeat_t: 142 bytes, 7 to 70 for the classes, about 4 a robot of the roster,
/// 4 of who has landed, 2 to 6 for battery and depth when either is known.
///
/// A roster that does not fit is cut at its high end; 256 robots fit when their numbers have few gaps.
/// @throws std::invalid_argument naming what is out of range, or when `max_payload` is below 200.
Bytes encode(const Heartbeat& heartbeat, size_t max_payload = kMaxMessageBytes);

/// The inverse. Whatever the bytes are, it returns; a heartbeat that it returns is within all ranges above
/// and encodes to the very same bytes.
Result<Heartbeat> decodeHeartbeat(std::span<const uint8_t> bytes);

}  // namespace shoal::wire
