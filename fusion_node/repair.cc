// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/repair.h"

#include <algorithm>

#include "fusion_node/limits.h"
#include "shoal/comms/channels.h"
#include "shoal/random.h"
#include "shoal/text_hash.h"
#include "shoal/wire/message_kind.h"
#include "shoal/wire/repair_codec.h"

namespace shoal::fusion_node {
namespace {

constexpr int64_t kSecondUs = 1'000'000;
constexpr int64_t kLatelyUs = 60 * kSecondUs;
constexpr int64_t kDatagramBytes = 700;
constexpr int kMostTalksPerSecond = 20;  // of one sender

// More of either would only wait in the queue, where nobody takes it back when somebody else has said it.
constexpr size_t kMaxWaitingRepairs = 2;
constexpr size_t kMaxWaitingUnlimited = 32;

// How long nobody who fuses has what we hold before we say so.
constexpr int64_t kUnmetUs = 15 * kSecondUs;

std::string repairKey(const comms::AntiEntropy::PieceName& piece) {
  return "repair/" + std::to_string(piece.first) + "/" + std::to_string(piece.second);
}

bool fuses(const wire::Heartbeat& node) { return node.phase == wire::Phase::kNode || node.map_of_state != 0; }

const wire::Heartbeat::Share* shareOf(const wire::Heartbeat& node, world::RobotId robot) {
  const auto at = std::ranges::lower_bound(node.roster, robot, {}, &wire::Heartbeat::Share::robot);
  return at != node.roster.end() && at->robot == robot ? &*at : nullptr;
}

comms::AntiEntropyOptions talkOptions(const RepairOptions& options) {
  comms::AntiEntropyOptions talk;
  talk.seed = hashCombine(static_cast<uint64_t>(options.mission), hashText(options.node));
  talk.own_share = options.own_share;
  if (options.budget > 0) {
    talk.unit_us = std::max(kSecondUs, kSecondUs * kDatagramBytes / options.budget);
    talk.talk_bytes_per_s = std::max<int64_t>(options.budget / 8, 1);
    talk.max_talk_bytes = static_cast<size_t>(std::clamp<int64_t>(options.budget / 2, 200, 500));
  } else {
    talk.talk_bytes_per_s = 2000;
    talk.max_talk_bytes = 1000;
  }
  if (!options.fuses) talk.patience_us = 15 * talk.unit_us;
  return talk;
}

}  // namespace

comms::AntiEntropy::PieceName nameOf(const mapping::PieceKey& key, int32_t part) {
  uint64_t hash = static_cast<uint64_t>(key.kind);
  for (const int32_t i : key.index) hash = hashCombine(hash, static_cast<uint32_t>(i));
  hash = hashCombine(hash, static_cast<uint64_t>(part));
  return {number(key.robot), hash >> (64 - comms::kKeyBits)};
}

uint64_t versionOf(const world::Version& version) {
  return static_cast<uint64_t>(version.epoch) << 32 | static_cast<uint32_t>(version.observation);
}

const StateHoldings::Tree& StateHoldings::made(int32_t share) {
  Tree& tree = trees_[share];
  const world::RobotId robot{share};
  const uint64_t digest = state_.beliefs().digestOf(robot);
  if (tree.digest == digest) return tree;
  tree = {digest, {}, {}};
  std::vector<comms::Leaf> leaves;
  state_.beliefs().visitHashesOf(robot, [&](const mapping::Piece& piece, uint64_t hash) {
    const uint64_t key = nameOf(piece.key, piece.part).second;
    leaves.push_back({key, versionOf(piece.version), hash});
    tree.pieces.emplace(key, std::pair(piece.key, piece.part));
  });
  tree.tree = comms::DigestTree(std::move(leaves));
  return tree;
}

const comms::DigestTree& StateHoldings::madeOfSaid(int32_t share) {
  const world::RobotId robot{share};
  const uint64_t digest = state_.beliefs().digestOf(robot);
  if (said_.digest == digest && said_.revision == queue_->revision()) return said_.tree;
  std::vector<comms::Leaf> leaves;
  state_.beliefs().visitHashesOf(robot, [&](const mapping::Piece& piece, uint64_t hash) {
    if (!is_unsaid_(piece))
      leaves.push_back({nameOf(piece.key, piece.part).second, versionOf(piece.version), hash});
  });
  said_ = {digest, queue_->revision(), comms::DigestTree(std::move(leaves))};
  return said_.tree;
}

const comms::DigestTree& StateHoldings::treeOf(int32_t share) {
  static const comms::DigestTree kNothing;
  if (state_.beliefs().digestOf(world::RobotId{share}) == 0) {
    trees_.erase(share);
    return kNothing;
  }
  const bool is_own = queue_ != nullptr && world::name(world::RobotId{share}) == node_;
  return is_own ? madeOfSaid(share) : made(share).tree;
}

const mapping::Piece* StateHoldings::find(const comms::AntiEntropy::PieceName& piece) {
  if (state_.beliefs().digestOf(world::RobotId{piece.first}) == 0) return nullptr;
  const Tree& tree = made(piece.first);
  const auto at = tree.pieces.find(piece.second);
  return at == tree.pieces.end() ? nullptr : state_.beliefs().find(at->second.first, at->second.second);
}

const wire::Heartbeat* StateHoldings::lately(const std::string& node) const {
  const auto heard = heard_us_.find(node);
  if (heard == heard_us_.end() || node == node_) return nullptr;
  const wire::Heartbeat& said = state_.heartbeats().at(node);
  // Under a thin budget they come seldom: docs/wire.md. Three of them may be lost.
  const int64_t stretched_us = said.budget > 0 ? 4 * 10 * 300 * kSecondUs / said.budget : 0;
  return now_us_ - heard->second <= std::max(kLatelyUs, stretched_us) ? &said : nullptr;
}

bool StateHoldings::hears(const std::string& node, int64_t now_us) {
  now_us_ = std::max(now_us_, now_us);
  return lately(node) != nullptr;
}

bool StateHoldings::isHeldByFusingNode(world::RobotId robot, uint32_t digest) const {
  return std::ranges::any_of(heard_us_, [&](const auto& heard) {
    const wire::Heartbeat* node = lately(heard.first);
    if (node == nullptr || !fuses(*node)) return false;
    const auto* share = shareOf(*node, robot);
    return share != nullptr && share->digest == digest;
  });
}

std::vector<wire::Heartbeat::Share> StateHoldings::unmet(int64_t now_us) {
  now_us_ = std::max(now_us_, now_us);
  std::vector<wire::Heartbeat::Share> unmet;
  for (const wire::Heartbeat::Share& share : state_.roster()) {
    if (world::name(share.robot) == node_) continue;
    if (isHeldByFusingNode(share.robot, share.digest)) {
      unmet_since_us_.erase(share.robot);
    } else if (now_us_ - unmet_since_us_.try_emplace(share.robot, now_us_).first->second >= kUnmetUs) {
      unmet.push_back(share);
    }
  }
  return unmet;
}

std::optional<int64_t> StateHoldings::missed(int32_t share) {
  if (share == number(mapping::kOperators)) return {};
  const std::string owner = world::name(world::RobotId{share});
  const wire::Heartbeat* said = lately(owner);
  if (said == nullptr || said->queue_bytes == 0) return {};
  return state_.missedOf(owner);
}

// What a robot says of itself is newer than what anybody else holds of it; when it is not heard, anybody may
// hold more than we do.
bool StateHoldings::isDoubted(int32_t share) {
  const world::RobotId robot{share};
  if (state_.beliefs().isFull(robot)) return false;  // there is no room for what we lack
  const uint32_t mine = wire::shareDigest(state_.beliefs().digestOf(robot));
  std::vector<uint32_t> others;
  const bool has_owner = robot != mapping::kOperators;
  const wire::Heartbeat* owner = has_owner ? lately(world::name(robot)) : nullptr;
  if (owner != nullptr) {
    if (owner->own_digest != 0) others.push_back(wire::shareDigest(owner->own_digest));
  } else {
    for (const auto& [node, heard] : heard_us_) {
      const wire::Heartbeat* said = lately(node);
      const auto* share_said = said == nullptr ? nullptr : shareOf(*said, robot);
      if (share_said != nullptr) others.push_back(share_said->digest);
    }
  }
  std::erase(others, mine);
  if (!patient_ || others.empty()) return !others.empty();
  std::erase_if(others, [&](uint32_t digest) { return isHeldByFusingNode(robot, digest); });
  return !others.empty();
}

std::vector<int32_t> StateHoldings::heardFrom(const std::string& node, int64_t now_us) {
  now_us_ = std::max(now_us_, now_us);
  const auto said = state_.heartbeats().find(node);
  if (said == state_.heartbeats().end() || node == node_) return {};
  heard_us_[node] = now_us_;
  std::vector<int32_t> differing;
  const auto compare = [&](world::RobotId robot, uint32_t digest) {
    if (digest != wire::shareDigest(state_.beliefs().digestOf(robot))) differing.push_back(number(robot));
  };
  const auto robot = world::parseRobotId(node);
  if (robot && said->second.own_digest != 0) compare(*robot, wire::shareDigest(said->second.own_digest));
  for (const auto& share : said->second.roster) compare(share.robot, share.digest);
  return differing;
}

Repair::Repair(const RepairOptions& options, MissionState& state, comms::Sender& sender)
    : options_(options),
      state_(state),
      sender_(sender),
      holdings_(state, options.node, !options.fuses),
      talk_(talkOptions(options), holdings_) {
  if (options.is_unsaid) holdings_.leaveOut(options.is_unsaid, sender.queue());
  state_.onPiece([this](const mapping::Piece& piece, bool repaired) {
    const auto name = nameOf(piece.key, piece.part);
    talk_.heard(name, versionOf(piece.version), repaired, now_us_);
    sender_.forget(repairKey(name));
  });
}

bool Repair::isFlood(const std::string& node, int64_t now_us) {
  if (!asks_.contains(node) && asks_.size() >= kMaxNodes) return true;
  auto& [second, count] = asks_[node];
  if (now_us / kSecondUs != second) {
    second = now_us / kSecondUs;
    count = 0;
  }
  return ++count > kMostTalksPerSecond;
}

void Repair::hear(const comms::Packet& packet, int64_t now_us) {
  now_us_ = std::max(now_us_, now_us);
  const auto channel = comms::parseChannel(packet.channel);
  const auto header = wire::peek(packet.bytes);
  if (!channel || !header || header->mission != options_.mission || channel->node == options_.node) return;
  if (wire::channelKind(header->kind) != channel->kind) return;  // counted already
  if (header->kind == wire::MessageKind::kHeartbeat) {
    for (const int32_t share : holdings_.heardFrom(channel->node, now_us_)) {
      if (holdings_.isDoubted(share)) talk_.doubt(share, now_us_);
    }
    return;
  }
  if (header->kind != wire::MessageKind::kRequest) return;
  const auto bytes = wire::decodeRequest(packet.bytes);
  if (!bytes) return sender_.stats().countRejected(wire::name(bytes.error()));
  const auto talk = comms::decodeTalk(*bytes);
  if (!talk) return sender_.stats().countRejected(wire::name(wire::DecodeError::kBadPayload));
  if (isFlood(channel->node, now_us_)) return sender_.stats().countRejected("too many requests");
  talk_.hear(*talk, now_us_);
  if (options_.make_wanted) makeWanted(*talk);
}

void Repair::makeWanted(const comms::RepairTalk& talk) {
  for (const comms::Statement& said : talk.statements) {
    if (said.kind != comms::Statement::Kind::kWanted || said.share != options_.own_share) continue;
    for (const auto& named : said.leaves) {
      const auto held = holdings_.treeOf(said.share).find(named.key);
      if (!held || held->version < named.version) options_.make_wanted(named.key);
    }
  }
}

void Repair::ask(const mapping::PieceKey& key, int32_t part, const world::Version& version) {
  talk_.want(nameOf(key, part), versionOf(version), now_us_);
}

int64_t Repair::pump(int64_t now_us) {
  now_us_ = std::max(now_us_, now_us);
  const auto waiting = [this](comms::TrafficClass traffic) { return sender_.queue().numWaiting(traffic); };
  while (waiting(comms::TrafficClass::kRequests) == 0) {
    const auto talk = talk_.nextTalk(now_us_);
    if (!talk) break;
    sender_.offer(comms::TrafficClass::kRequests, "request",
                  {comms::channelName(options_.node, "REQUEST"),
                   wire::encodeRequest(comms::encodeTalk(*talk), options_.mission, {})});
  }
  const size_t most = options_.budget == 0 ? kMaxWaitingUnlimited : kMaxWaitingRepairs;
  while (waiting(comms::TrafficClass::kRepairs) < most) {
    const auto name = talk_.nextRepair(now_us_);
    if (!name) break;
    const mapping::Piece* piece = holdings_.find(*name);
    if (piece == nullptr || (options_.is_unsaid && options_.is_unsaid(*piece))) continue;
    const std::string channel = comms::channelName(options_.node, "REPAIR");
    wire::Bytes message = wire::encodeRepair(*piece, options_.mission, {});
    if (message.size() > wire::maxPayload(channel.size())) continue;  // of a version that knew no repairs
    sender_.offer(comms::TrafficClass::kRepairs, repairKey(*name), {channel, std::move(message)});
  }
  // What finds no room goes when the sender has sent what waits.
  int64_t next_us = comms::AntiEntropy::kNever;
  if (waiting(comms::TrafficClass::kRequests) == 0) next_us = talk_.nextTalkDue(now_us_);
  if (waiting(comms::TrafficClass::kRepairs) < most)
    next_us = std::min(next_us, talk_.nextRepairDue(now_us_));
  return next_us;
}

std::vector<wire::Heartbeat::Share> Repair::roster(int64_t now_us) {
  return options_.fuses ? state_.roster() : holdings_.unmet(now_us);
}

}  // namespace shoal::fusion_node
