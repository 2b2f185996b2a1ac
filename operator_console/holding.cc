// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/holding.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "operator_console/message_log.h"
#include "operator_console/recorded_mission.h"
#include "shoal/mapping/library.h"
#include "shoal/rounded.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

constexpr int64_t kAll = std::numeric_limits<int64_t>::max();

// A robot's share of the state all through a recording: after which message it had which digest.
using Digests = std::map<uint32_t, int64_t>;

struct Heard {
  std::map<world::RobotId, Digests> digests;
  std::map<std::string, wire::Heartbeat> last;  // of every node
  std::vector<wire::Heartbeat> beats;           // of the one that is asked for
  int32_t mission = 0;
  std::map<world::RobotId, uint32_t> newest;
};

Heard listen(const std::string& recording, const std::string& key_file,
             const matching::MatcherOptions& matcher, const std::string& node,
             std::optional<world::Timestamp> until) {
  Heard heard;
  int64_t message = 0;
  uint64_t revision = 0;
  const auto on_message = [&](const comms::ChannelName& channel, const wire::Header& header,
                              const comms::Packet&, const fusion_node::MissionState& state) {
    ++message;
    if (header.kind == wire::MessageKind::kHeartbeat && channel.node == node)
      heard.beats.push_back(state.heartbeats().at(node));
    if (state.beliefs().revision() == revision) return;
    revision = state.beliefs().revision();
    for (const world::RobotId robot : state.beliefs().robots()) {
      const uint32_t digest = wire::shareDigest(state.beliefs().digestOf(robot));
      const auto [known, is_new] = heard.newest.emplace(robot, digest);
      if (!is_new && known->second == digest) continue;
      known->second = digest;
      heard.digests[robot][digest] = message;
    }
  };
  const RecordedMission recorded = readRecording(recording, matcher, on_message, until, key_file);
  heard.mission = recorded.mission;
  heard.last = recorded.state.heartbeats();
  return heard;
}

// Up to which message a node held a robot's share: what its newest roster says, or an older one that can be
// made out, when what it held was never what the recording had.
struct Limit {
  int64_t message = -1;
  bool is_certain = false;
};

Limit limitOf(const Heard& heard, world::RobotId robot) {
  const auto digests = heard.digests.find(robot);
  for (auto beat = heard.beats.rbegin(); beat != heard.beats.rend(); ++beat) {
    const auto share = std::ranges::find(beat->roster, robot, &wire::Heartbeat::Share::robot);
    if (share == beat->roster.end()) return {-1, beat == heard.beats.rbegin()};
    if (digests == heard.digests.end()) continue;
    const auto at = digests->second.find(share->digest);
    if (at != digests->second.end()) return {at->second, beat == heard.beats.rbegin()};
  }
  return {};
}

bool isWhole(const Heard& heard, world::RobotId robot, uint32_t digest) {
  const auto said = heard.last.find(name(robot));
  if (said != heard.last.end()) return wire::shareDigest(said->second.own_digest) == digest;
  const auto newest = heard.newest.find(robot);
  return newest != heard.newest.end() && newest->second == digest;
}

// The same walk as readRecording()'s, with what is within the limits taken in.
std::map<world::RobotId, double> takeIn(const std::string& recording, const std::string& key_file,
                                        std::optional<world::Timestamp> until,
                                        const std::map<world::RobotId, Limit>& limits, int32_t mission,
                                        const matching::MatcherOptions& matcher,
                                        fusion_node::MissionState& held) {
  std::map<world::RobotId, double> until_s;
  fusion_node::MissionState decoder(mission, matcher);
  double now_s = 0;
  std::vector<mapping::Piece> pieces;
  decoder.onPiece([&](const mapping::Piece& piece, bool) { pieces.push_back(piece); });
  int64_t message = 0;
  size_t refused = 0;
  comms::Stats stats;
  MessageLog log(recording, key_file);
  while (const auto event = log.next()) {
    if (!event->packet.channel.starts_with("SHOAL_")) continue;
    const auto header = wire::peek(event->packet.bytes);
    if (until && header && header->time > *until) continue;
    pieces.clear();
    decoder.hear(event->packet, stats);
    size_t now_refused = 0;
    for (const auto& [reason, count] : stats.rejected) now_refused += count;
    if (now_refused != refused) {
      refused = now_refused;
      continue;
    }
    ++message;
    if (header->kind == wire::MessageKind::kHeartbeat) held.hear(event->packet, stats);
    now_s = header->time.seconds();
    for (const mapping::Piece& piece : pieces) {
      const auto limit = limits.find(piece.key.robot);
      if (limit == limits.end() || message > limit->second.message) continue;
      held.apply(piece);
      until_s[piece.key.robot] = std::max(until_s[piece.key.robot], now_s);
    }
  }
  return until_s;
}

std::string shareName(world::RobotId robot) {
  if (robot == mapping::kOperators) return "operators";
  if (robot == mapping::kLibrary) return "library";
  return name(robot);
}

}  // namespace

Json Holding::json() const {
  Json rows = Json::array();
  for (const Share& share : shares)
    rows.push_back({{"robot", shareName(share.robot)},
                    {"whole", share.is_whole},
                    {"certain", share.is_certain},
                    {"until_s", rounded(share.until_s, 1e3)}});
  return {{"node", node},
          {"at_s", rounded(at_s, 1e3)},
          {"fuses", fuses},
          {"agrees", agrees ? Json(*agrees) : Json()},
          {"shares", std::move(rows)}};
}

Holding holdingOf(const std::string& recording, const std::string& key_file,
                  const matching::MatcherOptions& matcher, const std::string& node,
                  std::optional<world::Timestamp> until) {
  const Heard heard = listen(recording, key_file, matcher, node, until);
  if (heard.beats.empty()) {
    std::string known;
    for (const auto& [other, beat] : heard.last) known += " " + other;
    throw std::runtime_error("nothing was heard of " + node + " by then; of these it was:" + known);
  }
  const wire::Heartbeat& said = heard.beats.back();
  Holding holding{.node = node,
                  .at_s = said.time.seconds(),
                  .fuses = said.phase == wire::Phase::kNode || said.map_of_state != 0,
                  .agrees = {},
                  .shares = {},
                  .state = {heard.mission, matcher}};
  std::map<world::RobotId, Limit> limits;
  if (holding.fuses)
    for (const auto& [robot, digests] : heard.digests) limits[robot] = limitOf(heard, robot);
  if (const auto itself = world::parseRobotId(node)) limits[*itself] = {kAll, true};
  const auto until_s = takeIn(recording, key_file, until, limits, heard.mission, matcher, holding.state);
  holding.state.refreshMap();
  const mapping::BeliefStore& beliefs = holding.state.beliefs();
  for (const auto& [robot, limit] : limits) {
    const auto last = until_s.find(robot);
    const uint32_t digest = wire::shareDigest(beliefs.digestOf(robot));
    holding.shares.push_back(
        {robot, isWhole(heard, robot, digest), limit.is_certain, last == until_s.end() ? 0.0 : last->second});
  }
  if (holding.fuses && said.map_of_state == beliefs.digest())
    holding.agrees = said.map_digest == holding.state.mapDigest();
  return holding;
}

}  // namespace shoal::console
