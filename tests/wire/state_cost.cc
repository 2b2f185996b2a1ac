// SPDX-License-Identifier: BSD-3-Clause
#include "state_cost.h"

#include <map>
#include <span>
#include <stdexcept>

#include "shoal/mapping/belief_pieces.h"
#include "shoal/wire/cut.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"

namespace shoal::wire {
namespace {

// What a channel like SHOAL_R00_BRICK adds to a message in a datagram: LCM's header, the name, its NUL.
constexpr size_t kAround = 8 + 15 + 1;
constexpr size_t kMost = maxPayload(16);

}  // namespace

std::vector<Bytes> messagesOf(const std::vector<mapping::Piece>& pieces) {
  std::vector<mapping::Piece> parts;
  for (const mapping::Piece& piece : pieces) {
    const bool is_topic = piece.key.kind == mapping::PieceKind::kTopic;
    for (mapping::Piece& part : is_topic ? cutToFit(piece, kMost) : std::vector{piece})
      parts.push_back(std::move(part));
  }
  const auto together = [&](size_t begin, size_t end) {
    return encode(std::span(parts).subspan(begin, end - begin), 1, {});
  };
  const auto fits = [&](size_t begin, size_t end) {
    try {
      return together(begin, end).size() <= kMost;
    } catch (const std::invalid_argument&) {
      return false;  // too long, too many cells, or two parts of a topic
    }
  };
  std::vector<Bytes> messages;
  for (const auto& [begin, end] : cutRuns(parts.size(), kMaxBricksPerMessage, fits))
    messages.push_back(together(begin, end));
  return messages;
}

Cost costOf(const std::vector<mapping::Piece>& pieces) {
  Cost cost;
  if (pieces.empty()) return cost;
  for (const Bytes& message : messagesOf(pieces)) {
    cost.payload += message.size() - fixedBytesOf(kindOf(pieces.front()));
    cost.datagrams += message.size() + kAround;
    ++cost.count;
  }
  return cost;
}

StateCost costOfState(const mapping::LocalBelief& belief) {
  std::map<mapping::PieceKind, std::vector<mapping::Piece>> pieces;
  for (mapping::Piece& piece : mapping::wholePieces(belief))
    pieces[piece.key.kind].push_back(std::move(piece));
  return {costOf(pieces[mapping::PieceKind::kTopic]), costOf(pieces[mapping::PieceKind::kBrick]),
          costOf(pieces[mapping::PieceKind::kCertainty])};
}

}  // namespace shoal::wire
