// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/recording_repair.h"

#include <set>

#include "fusion_node/mission_state.h"
#include "fusion_node/repair.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/log_reader.h"
#include "shoal/comms/repair_talk.h"
#include "shoal/mapping/library.h"
#include "shoal/wire/repair_codec.h"
#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

constexpr const char* kNode = "LAUNCH";
constexpr size_t kMostLeaves = 12;  // of one statement: about 80 bytes

std::set<int32_t> differingShares(const mapping::BeliefStore& beliefs,
                                  const std::map<std::string, wire::Heartbeat>& heartbeats) {
  std::set<int32_t> shares;
  for (const auto& [node, heartbeat] : heartbeats) {
    if (const auto robot = world::parseRobotId(node)) {
      if (heartbeat.own_digest != beliefs.digestOf(*robot)) shares.insert(number(*robot));
    }
    for (const auto& share : heartbeat.roster) {  // what operators decided, and knew before
      if ((share.robot == mapping::kOperators || share.robot == mapping::kLibrary) &&
          share.digest != wire::shareDigest(beliefs.digestOf(share.robot)))
        shares.insert(number(share.robot));
    }
  }
  return shares;
}

void addStatements(const comms::DigestTree& tree, int32_t share, const comms::TreeNode& node,
                   std::vector<comms::Statement>& statements) {
  const auto leaves = tree.leaves(node);
  if (leaves.size() > kMostLeaves && node.depth < comms::kMaxTreeDepth) {
    for (int i = 0; i < comms::kTreeFanout; ++i) addStatements(tree, share, node.child(i), statements);
    return;
  }
  comms::Statement statement{comms::Statement::Kind::kLeaves, share, true, node, {}, {}};
  for (const comms::Leaf& leaf : leaves) statement.leaves.push_back({leaf.key, leaf.version});
  statements.push_back(std::move(statement));
}

}  // namespace

std::vector<comms::Packet> requestsForRecording(const std::string& path, int32_t mission,
                                                const std::map<std::string, wire::Heartbeat>& heartbeats,
                                                size_t most_bytes) {
  fusion_node::MissionState state(mission, {});
  comms::Stats refused;
  comms::LogReader log(path);
  while (const auto event = log.next()) state.hear(event->packet, refused);
  fusion_node::StateHoldings holdings(state, kNode, false);
  std::vector<comms::Statement> statements;
  for (const int32_t share : differingShares(state.beliefs(), heartbeats)) {
    addStatements(holdings.treeOf(share), share, {}, statements);
  }
  std::vector<comms::Packet> packets;
  const auto finish = [&](const comms::RepairTalk& talk) {
    packets.push_back(
        {comms::channelName(kNode, "REQUEST"), wire::encodeRequest(comms::encodeTalk(talk), mission, {})});
  };
  comms::RepairTalk talk;
  size_t size = 4;
  for (comms::Statement& statement : statements) {
    const size_t more = comms::encodedSize(statement);
    if (!talk.statements.empty() &&
        (size + more > most_bytes || talk.statements.size() == comms::kMaxStatements)) {
      finish(talk);
      talk.statements.clear();
      size = 4;
    }
    size += more;
    talk.statements.push_back(std::move(statement));
  }
  if (!talk.statements.empty()) finish(talk);
  return packets;
}

}  // namespace shoal::console
