// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/spy.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/authentication.h"
#include "operator_console/terminal.h"
#include "shoal/comms/channels.h"
#include "shoal/rounded.h"
#include "shoal/wire/heartbeat_codec.h"
#include "shoal/wire/message_json.h"
#include "shoal/wire/message_kind.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMostChannels = 1000;
constexpr size_t kMaxRecent = 2000;  // messages of a channel
constexpr size_t kMaxSent = 20000;   // datagrams of a node, for its worst window
constexpr double kWindowS = 10;
constexpr size_t kFieldColumns = 58;
constexpr size_t kShownItems = 6;       // of a list
constexpr size_t kMaxKept = 64 * 1024;  // bytes of a message that is kept to be decoded

// Long lists end where a person stops reading.
void shorten(Json& json) {
  if (json.is_array() && json.size() > kShownItems && json.size() > 12) {
    const size_t more = json.size() - kShownItems;
    json.erase(json.begin() + kShownItems, json.end());
    json.push_back("and " + std::to_string(more) + " more");
  }
  if (json.is_structured())
    for (Json& item : json) shorten(item);
}

}  // namespace

bool Spy::isShown(const std::string& channel) const { return !shown_ || std::regex_match(channel, *shown_); }

void Spy::hear(const comms::Packet& heard, double at_s) {
  comms::Packet packet = heard;
  if (fusion_node::isSealed(packet)) comms::removeSeal(packet);  // unseen: who spies looks at all there is
  ++messages_;
  if (!first_s_) first_s_ = at_s;
  const bool is_sound = hearNode(packet);
  if (!isShown(packet.channel)) return;
  const size_t size = comms::wireSize(packet);
  auto found = channels_.find(packet.channel);
  if (found == channels_.end()) {
    if (channels_.size() >= kMostChannels) {
      ++unlisted_;
      return;
    }
    found = channels_.emplace(packet.channel, Channel{}).first;
  }
  Channel& c = found->second;
  ++c.messages;
  c.bytes += static_cast<int64_t>(size);
  c.refused += is_sound ? 0 : 1;
  c.last_s = std::max(c.last_s, at_s);
  c.recent.emplace_back(at_s, size);
  if (c.recent.size() > kMaxRecent) c.recent.pop_front();
  const auto header = wire::peek(packet.bytes);
  c.type = header ? std::string(wire::channelKind(header->kind)) : "?";
  if (packet.bytes.size() <= kMaxKept) c.last = packet;
}

// Whose budget it was. False when it is on a channel of ours and not sound.
bool Spy::hearNode(const comms::Packet& packet) {
  const auto known = comms::parseChannel(packet.channel);
  if (!known) return true;
  const auto header = wire::peek(packet.bytes);
  if (!header || wire::channelKind(header->kind) != known->kind) return false;
  if (header->kind == wire::MessageKind::kMap) return true;  // stays on its own host
  if (!nodes_.contains(known->node) && nodes_.size() >= kMostChannels) return true;
  Node& node = nodes_[known->node];
  if (node.bytes == 0) node.first_us = header->time.us;
  node.first_us = std::min(node.first_us, header->time.us);
  node.last_us = std::max(node.last_us, header->time.us);
  node.bytes += static_cast<int64_t>(comms::wireSize(packet));
  node.sent.emplace_back(header->time.us, comms::wireSize(packet));
  if (node.sent.size() > kMaxSent) node.sent.pop_front();
  if (header->kind != wire::MessageKind::kHeartbeat) return true;
  const auto heartbeat = wire::decodeHeartbeat(packet.bytes);
  if (heartbeat) node.budget = heartbeat->budget;
  return heartbeat.ok();
}

Json Spy::json(double now_s) const {
  const double seconds = first_s_ ? std::max(now_s - *first_s_, 0.0) : 0.0;
  Json answer{{"seconds", rounded(seconds, 1e3)},
              {"messages", messages_},
              {"unlisted", unlisted_},
              {"channels", Json::array()},
              {"nodes", Json::array()}};
  for (const auto& [name, c] : channels_) {
    const double window = std::max(of_all_ ? seconds : std::min(kWindowS, seconds), 1.0);
    int64_t messages = of_all_ ? c.messages : 0, bytes = of_all_ ? c.bytes : 0;
    for (const auto& [at, size] : c.recent) {
      if (of_all_ || at <= now_s - window) continue;
      ++messages;
      bytes += static_cast<int64_t>(size);
    }
    Json row{{"channel", name},
             {"type", c.type},
             {"messages", c.messages},
             {"bytes", c.bytes},
             {"hz", rounded(static_cast<double>(messages) / window, 1e2)},
             {"bytes_per_s", rounded(static_cast<double>(bytes) / window, 10)},
             {"ago_s", rounded(std::max(now_s - c.last_s, 0.0), 1e3)},
             {"refused", c.refused}};
    if (shown_) row["last"] = wire::messageJson(name, c.last.bytes);
    answer["channels"].push_back(std::move(row));
  }
  for (const auto& [name, n] : nodes_) {
    comms::WindowMeter meter(std::max<int64_t>(n.budget, 0));
    for (const auto& [at_us, size] : n.sent) meter.add(at_us, size);
    const double span_s = std::max(static_cast<double>(n.last_us - n.first_us) * 1e-6, 1.0);
    answer["nodes"].push_back({{"node", name},
                               {"budget", n.budget < 0 ? Json() : Json(n.budget)},
                               {"bytes", n.bytes},
                               {"bytes_per_s", rounded(static_cast<double>(n.bytes) / span_s, 10)},
                               {"worst", n.budget > 0 ? Json(rounded(meter.worst().share, 1e3)) : Json()}});
  }
  return answer;
}

std::string Spy::text(double now_s, bool shortens) const {
  const Json a = json(now_s);
  const auto fitted = [shortens](const std::string& name, size_t width) {
    return shortens ? shortened(name, width) : fmt::format("{:<{}}", name, width);
  };
  std::string text = fmt::format("{:<30} {:<10} {:>8} {:>7} {:>8} {:>6} {:>4}\n", "channel", "type",
                                 "messages", "Hz", "B/s", "ago s", "bad");
  for (const Json& c : a["channels"]) {
    text += fmt::format("{} {:<10} {:>8} {:>7.1f} {:>8.0f} {:>6.1f} {:>4}\n",
                        fitted(c["channel"].get<std::string>(), 30), c["type"].get<std::string>(),
                        c["messages"].get<int64_t>(), c["hz"].get<double>(), c["bytes_per_s"].get<double>(),
                        c["ago_s"].get<double>(), c["refused"].get<int64_t>());
  }
  if (a["channels"].empty()) text += "nothing was heard\n";
  if (unlisted_ > 0) text += fmt::format("and {} messages on further channels\n", unlisted_);
  if (!a["nodes"].empty()) {
    text += fmt::format("\n{:<16} {:>10} {:>12} {:>12} {:>14}\n", "node", "bytes", "B/s (mission)",
                        "budget B/s", "fullest window");
  }
  for (const Json& n : a["nodes"]) {
    const std::string budget = n["budget"].is_null() ? "?" : n["budget"] == 0 ? "none" : n["budget"].dump();
    text += fmt::format("{:<16} {:>10} {:>13.0f} {:>12} {:>14}\n", n["node"].get<std::string>(),
                        n["bytes"].get<int64_t>(), n["bytes_per_s"].get<double>(), budget,
                        n["worst"].is_null() ? "-" : fmt::format("{:.0f} %", 100 * n["worst"].get<double>()));
  }
  for (const Json& c : a["channels"]) {
    if (!c.contains("last")) continue;
    Json last = c["last"];
    if (shortens) shorten(last);
    text += "\n" + c["channel"].get<std::string>() + "\n";
    for (const auto& [key, value] : last.items()) {
      if (key == "channel") continue;
      std::string shown = value.is_string() ? value.get<std::string>() : value.dump();
      if (shortens && shown.size() > kFieldColumns) shown = shortened(shown, kFieldColumns);
      text += fmt::format("  {:<18} {}\n", key, shown);
    }
  }
  return text;
}

}  // namespace shoal::console
