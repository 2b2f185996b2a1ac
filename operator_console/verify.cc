// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/verify.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

#include "operator_console/agreement.h"
#include "operator_console/log_check.h"
#include "shoal/mapping/common_settings.h"
#include "shoal/world/ids.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

int64_t bytesLacking(const NodeTraffic& node) {
  int64_t bytes = 0;
  for (const Gap& gap : node.gaps) bytes += gap.bytes;
  return bytes;
}

// Nodes of one mission that do not belong together.
std::vector<std::string> mixedUp(const fusion_node::MissionState& state) {
  std::vector<std::string> lines;
  for (const mapping::Mixture& mixture : state.mixtures()) lines.push_back(mixture.says);
  const std::pair<const std::string, wire::Heartbeat>* first = nullptr;
  for (const auto& node : state.heartbeats()) {
    if (node.second.phase == wire::Phase::kNode) continue;
    if (first == nullptr) first = &node;
    const auto robot = world::parseRobotId(node.first);
    const bool is_told = robot && mapping::commonSettings(state.beliefs(), {});  // by mixtures()
    if (!is_told && node.second.vocabulary != first->second.vocabulary) {
      lines.push_back(node.first + " has another vocabulary, or hyper-parameters, than " + first->first);
    }
    if (!is_told && node.second.cell_size_m != first->second.cell_size_m) {
      lines.push_back(fmt::format("{} has cells of {} m, {} of {} m", node.first, node.second.cell_size_m,
                                  first->first, first->second.cell_size_m));
    }
  }
  return lines;
}

Json orNull(const std::optional<double>& value) { return value ? Json(*value) : Json(); }

std::string shareText(const NodeTraffic& node) {
  if (node.budget == 0) return "unlimited";
  return fmt::format("{:.1f} %{}", 100 * node.worst.share, node.worst.within_budget ? "" : " OVER");
}

}  // namespace

bool Verification::budgetKept() const {
  return std::ranges::all_of(traffic, [](const NodeTraffic& node) { return node.worst.within_budget; });
}

std::vector<std::string> Verification::wrong() const {
  std::vector<std::string> lines;
  for (const NodeTraffic& node : traffic) {
    if (node.worst.within_budget) continue;
    lines.push_back(fmt::format("{} sent {} bytes in {:.3f} s from {:.3f} s on, over its budget of {} B/s",
                                node.node, node.worst.bytes, world::Timestamp{node.worst.length_us}.seconds(),
                                world::Timestamp{node.worst.start_us}.seconds(), node.budget));
  }
  for (const std::string& line : lacking) lines.push_back("not in the recording: " + line);
  lines.insert(lines.end(), disagreements.begin(), disagreements.end());
  if (lacking.empty() && disagreements.empty()) {
    for (const auto& [node, heartbeat] : recorded.state.heartbeats()) {
      if (heartbeat.map_of_state == 0 || heartbeat.state_digest == recorded.state.beliefs().digest())
        continue;
      lines.push_back(node + " holds another state than the recording adds up to");
    }
  }
  lines.insert(lines.end(), mixed.begin(), mixed.end());
  return lines;
}

Json Verification::json() const {
  Json nodes = Json::array();
  int64_t lost = 0;
  for (const NodeTraffic& node : traffic) {
    Json gaps = Json::array();
    for (const Gap& gap : node.gaps)
      gaps.push_back({{"from_s", gap.from_s}, {"until_s", gap.until_s}, {"bytes", gap.bytes}});
    lost += bytesLacking(node);
    nodes.push_back({{"node", node.node},
                     {"pid", node.pid},
                     {"budget", node.budget},
                     {"bytes", node.bytes},
                     {"datagrams", node.datagrams},
                     {"worst_window",
                      {{"start_s", world::Timestamp{node.worst.start_us}.seconds()},
                       {"length_s", world::Timestamp{node.worst.length_us}.seconds()},
                       {"bytes", node.worst.bytes},
                       {"datagrams", node.worst.datagrams},
                       {"share", node.worst.share},
                       {"within_budget", node.worst.within_budget}}},
                     {"gaps", gaps}});
  }
  const fusion_node::MissionState& state = recorded.state;
  Json digests = Json::object();
  for (const auto& [node, heartbeat] : state.heartbeats()) {
    if (heartbeat.map_of_state == 0) continue;
    digests[node] = {{"state", fmt::format("{:016x}", heartbeat.state_digest)},
                     {"map", fmt::format("{:016x}", heartbeat.map_digest)}};
  }
  const std::vector<std::string> faults = wrong();
  return {{"log", log},
          {"mission_id", recorded.mission},
          {"messages", recorded.messages},
          {"refused", recorded.refused},
          {"seals", recorded.seals.json()},
          {"budget_kept", budgetKept()},
          {"nodes", nodes},
          {"bytes_not_recorded", lost},
          {"gaps_repaired", lacking.empty()},
          {"lacking", lacking},
          {"landed_s", orNull(landed_s)},
          {"agreed_s", orNull(agreed_s)},
          {"digests_equal", disagreements.empty()},
          {"digests", {{"recording", fmt::format("{:016x}", state.beliefs().digest())}, {"nodes", digests}}},
          {"good", faults.empty()},
          {"wrong", faults}};
}

std::string Verification::text() const {
  std::string text = fmt::format("mission {}: {} messages, {} refused\n\n", recorded.mission,
                                 recorded.messages, recorded.refused);
  text += fmt::format("{:<10} {:>10} {:>10} {:>10} {:>10} {:>10} {:>12} {:>6} {:>12}\n", "node", "budget B/s",
                      "bytes", "datagrams", "worst B", "in s", "of budget", "gaps", "not recorded");
  for (const NodeTraffic& node : traffic) {
    text += fmt::format("{:<10} {:>10} {:>10} {:>10} {:>10} {:>10.3f} {:>12} {:>6} {:>12}\n", node.node,
                        node.budget, node.bytes, node.datagrams, node.worst.bytes,
                        world::Timestamp{node.worst.length_us}.seconds(), shareText(node), node.gaps.size(),
                        bytesLacking(node));
  }
  text += fmt::format("\nbudget: {}\n", budgetKept() ? "kept in every window" : "NOT kept");
  text += fmt::format("gaps: {}\n", lacking.empty() ? "nothing lacks in the end" : "NOT repaired");
  if (agreed_s) {
    text += fmt::format("agreement: {:.3f} s after the last robot had landed at {:.3f} s\n",
                        *agreed_s - *landed_s, *landed_s);
  } else {
    text += "agreement: NONE\n";
  }
  text += fmt::format("digests: {}\n", disagreements.empty() ? "equal" : "NOT equal");
  text += recorded.seals.text();
  for (const std::string& line : wrong()) text += "wrong: " + line + "\n";
  return text;
}

Verification verify(const std::string& log, const std::string& key_file) {
  TrafficAudit traffic;
  Agreement agreement;
  const auto hear = [&](const comms::ChannelName& channel, const wire::Header& header,
                        const comms::Packet& packet, const fusion_node::MissionState& state) {
    if (header.kind != wire::MessageKind::kHeartbeat) {
      traffic.hear(channel.node, header, packet, nullptr);
      return;
    }
    const auto heartbeat = wire::decodeHeartbeat(packet.bytes);
    traffic.hear(channel.node, header, packet, heartbeat ? &*heartbeat : nullptr);
    agreement.update(state.heartbeats());
  };
  Verification result{log, readRecording(log, {}, hear, {}, key_file), {}, {}, {}, {}, {}, {}};
  const fusion_node::MissionState& state = result.recorded.state;
  result.traffic = traffic.traffic();
  result.lacking = lackingPieces(log, result.recorded.mission, state.beliefs(), state.heartbeats(), key_file);
  result.landed_s = agreement.landedAt();
  result.agreed_s = agreement.agreedAt();
  result.disagreements = disagreements(state.heartbeats());
  result.mixed = mixedUp(state);
  return result;
}

}  // namespace shoal::console
