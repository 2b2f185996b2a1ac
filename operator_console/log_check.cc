// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/log_check.h"

#include "fusion_node/mission_state.h"
#include "operator_console/message_log.h"
#include "operator_console/piece_audit.h"
#include "shoal/comms/channels.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/piece_codec.h"
#include "shoal/wire/repair_codec.h"
#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

PieceAudit auditOf(const std::string& path, int32_t mission, const std::string& key_file) {
  PieceAudit pieces;
  MessageLog log(path, key_file);
  while (const auto event = log.next()) {
    const auto header = wire::peek(event->packet.bytes);
    const auto channel = comms::parseChannel(event->packet.channel);
    if (!header || !channel || header->mission != mission) continue;
    if (header->kind == wire::MessageKind::kRepair) {
      if (const auto repaired = wire::decodeRepair(event->packet.bytes)) pieces.hear(*repaired);
      continue;
    }
    const auto heard = wire::decodePieces(header->kind, event->packet.bytes);
    if (!heard) continue;
    for (const mapping::Piece& piece : *heard)
      if (world::name(piece.key.robot) == channel->node) pieces.hear(piece);
  }
  return pieces;
}

}  // namespace

std::vector<std::string> lackingPieces(const std::string& path, int32_t mission,
                                       const mapping::BeliefStore& beliefs,
                                       const std::map<std::string, wire::Heartbeat>& heartbeats,
                                       const std::string& key_file) {
  std::map<world::RobotId, const wire::Heartbeat*> incomplete;
  for (const auto& [node, heartbeat] : heartbeats) {
    const auto robot = world::parseRobotId(node);
    if (robot && beliefs.digestOf(*robot) != heartbeat.own_digest) incomplete[*robot] = &heartbeat;
  }
  if (incomplete.empty()) return {};
  const PieceAudit pieces = auditOf(path, mission, key_file);
  std::vector<std::string> lacking;
  for (const auto& [robot, heartbeat] : incomplete) {
    for (std::string& line : pieces.lacking(robot, *heartbeat)) lacking.push_back(std::move(line));
  }
  return lacking;
}

std::vector<std::string> lackingInLog(const std::string& path, int32_t mission, uint64_t state_digest,
                                      const std::map<std::string, wire::Heartbeat>& heartbeats,
                                      const std::string& key_file) {
  fusion_node::MissionState state(mission, {});
  comms::Stats refused;
  MessageLog log(path, key_file);
  while (const auto event = log.next()) state.hear(event->packet, refused);

  std::vector<std::string> lacking = lackingPieces(path, mission, state.beliefs(), heartbeats, key_file);
  for (std::string& line : lacking) line = path + " lacks " + line;
  if (lacking.empty() && state.beliefs().digest() != state_digest) {
    lacking.push_back(path + " adds up to another state than OPERATOR's");
  }
  return lacking;
}

}  // namespace shoal::console
