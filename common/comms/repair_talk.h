// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "shoal/comms/digest_tree.h"
#include "shoal/comms/packet.h"

namespace shoal::comms {

/// Caps on what one message may make a receiver do. No honest sender reaches them.
inline constexpr size_t kMaxStatements = 256;
inline constexpr size_t kMaxStatementLeaves = 256;
inline constexpr int32_t kMaxShare = 65535;

/// One sentence of the talk by which nodes find out what they lack.
struct Statement {
  enum class Kind : uint8_t {
    kChildren = 0,  ///< "what I hold below this node has these digests"
    kLeaves = 1,    ///< "I hold these below this node, and nothing else"
    kWanted = 2     ///< "would somebody say these, in these versions or newer ones"
  };
  struct Named {
    uint64_t key = 0;
    uint64_t version = 0;
    friend bool operator==(const Named&, const Named&) = default;
  };

  Kind kind = Kind::kLeaves;
  int32_t share = 0;   ///< in [0, kMaxShare]
  bool asks = false;   ///< children, leaves: the speaker wants to be told what it lacks there
  TreeNode node = {};  ///< children, leaves; {} for wanted
  std::array<uint16_t, kTreeFanout> children{};  ///< children: foldedDigest() of each child
  std::vector<Named> leaves = {};                ///< leaves, wanted: ascending by key
  friend bool operator==(const Statement&, const Statement&) = default;
};

/// What one node says at once.
struct RepairTalk {
  uint32_t salt = 0;  ///< of its folded digests: two that fold alike in one message differ in the next
  std::vector<Statement> statements = {};  ///< at most kMaxStatements
  friend bool operator==(const RepairTalk&, const RepairTalk&) = default;
};

/// Sixteen bits of a digest; 0 only for 0, which is "nothing here" (or a chance of 2^-64).
uint16_t foldedDigest(uint64_t digest, uint32_t salt);

/// As bytes, see docs/wire.md. A list of n leaves takes about 6.5 n bytes, sixteen children 36.
Bytes encodeTalk(const RepairTalk& talk);

/// The inverse; nothing unless the bytes are exactly what encodeTalk() makes of a talk within the caps.
std::optional<RepairTalk> decodeTalk(std::span<const uint8_t> bytes);

/// Bytes that a statement adds to a talk.
size_t encodedSize(const Statement& statement);

}  // namespace shoal::comms
