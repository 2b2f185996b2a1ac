// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/serve/chronicle.h"
#include "shoal/rounded.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

constexpr size_t kMaxPoints = 1000;  // of a track
constexpr size_t kMaxBins = 240;
constexpr size_t kMaxEvents = 2000;

}  // namespace

void Chronicle::tell(double time_s, const std::string& kind, const std::string& text) {
  if (events_.size() > kMaxEvents) return;
  if (events_.size() == kMaxEvents) {
    events_.push_back({time_s, "alarm", "too much happens: later events are not listed"});
    return;
  }
  events_.push_back({time_s, kind, text});
}

void Chronicle::hear(const mapping::NodeStatus& node) {
  const bool is_new = !lives_.contains(node.name);
  Life& life = lives_[node.name];
  if (!is_new && node.heard_s <= life.heard_s && node.phase == life.phase && node.agreement == life.agreement)
    return;
  if (is_new) {
    tell(node.heard_s, "joined", node.name + (node.phase == "node" ? " is listening" : " joined"));
  } else if (life.phase != node.phase) {
    const bool has_looked = life.phase == "listening" && node.phase == "landed";
    tell(node.heard_s,
         has_looked                  ? "looked"
         : node.phase == "listening" ? "landed"
                                     : node.phase,
         node.name + (has_looked                  ? " has looked again at its map"
                      : node.phase == "listening" ? " landed"
                      : node.phase == "landed"    ? " landed"
                      : node.phase == "leaving"   ? " is leaving"
                                                  : " flies again"));
  }
  if (node.agreement == "other" && life.agreement != "other")
    tell(node.heard_s, "alarm", node.name + " holds the same state and another map");
  if (node.conflicts > life.conflicts)
    tell(node.heard_s, "alarm", node.name + " met two processes with one name");
  if (node.rejected > 0 && life.rejected == 0)
    tell(node.heard_s, "rejected", node.name + " refuses messages that it does not understand");
  life.conflicts = std::max<int64_t>(life.conflicts, node.conflicts);
  life.rejected = node.rejected;
  life.agreement = node.agreement;
  life.phase = node.phase;
  life.budget = node.budget;
  const double since_s = is_new ? node.heard_s : life.heard_s;
  life.heard_s = node.heard_s;
  if (node.phase != "node" && node.observation >= 0)
    follow(life, {node.heard_s, node.x_m, node.y_m, node.z_m});
  std::map<std::string, int64_t> sent = node.class_bytes;
  if (sent.empty()) sent["sent"] = node.bytes_sent;
  for (const auto& [name, bytes] : sent) {
    const int64_t before = life.sent[name];
    spread(life, name, bytes >= before ? bytes - before : bytes, since_s,
           node.heard_s);  // less: it began anew
    life.sent[name] = bytes;
  }
  while (life.bins.size() > kMaxBins) coarsen();
}

// What was sent between two heartbeats, which may be far apart in what a node remembers, was sent evenly.
void Chronicle::spread(Life& life, const std::string& traffic, int64_t bytes, double since_s,
                       double until_s) const {
  const auto last = static_cast<int64_t>(std::floor(until_s / bin_s_));
  auto bin = std::min(static_cast<int64_t>(std::floor(since_s / bin_s_)) + 1, last);
  if (last - bin >= static_cast<int64_t>(kMaxBins)) bin = last;
  for (; bin <= last; ++bin) {
    const int64_t share = bytes / (last - bin + 1);
    life.bins[bin][traffic] += share;
    bytes -= share;
  }
}

// Every second point goes when there are many, and from then on every second one is left out.
void Chronicle::follow(Life& life, const TrackPoint& point) {
  if (life.skipped++ % life.stride == 0) life.points.push_back(point);
  if (life.points.size() <= kMaxPoints) return;
  for (size_t i = 0; 2 * i < life.points.size(); ++i) life.points[i] = life.points[2 * i];
  life.points.resize((life.points.size() + 1) / 2);
  life.stride *= 2;
}

void Chronicle::track(const std::string& node, const std::vector<TrackPoint>& points) {
  const auto life = lives_.find(node);
  if (life == lives_.end()) return;
  life->second.points.clear();
  life->second.stride = 1;
  life->second.skipped = 0;
  for (const TrackPoint& point : points) follow(life->second, point);
}

void Chronicle::coarsen() {
  bin_s_ *= 2;
  for (auto& [name, life] : lives_) {
    std::map<int64_t, std::map<std::string, int64_t>> wider;
    for (const auto& [bin, classes] : life.bins) {
      auto& into = wider[static_cast<int64_t>(std::floor(static_cast<double>(bin) / 2))];
      for (const auto& [traffic, bytes] : classes) into[traffic] += bytes;
    }
    life.bins = std::move(wider);
  }
}

void Chronicle::hearLabels(double time_s, const Json& labels) {
  for (const Json& row : labels.at("labels")) {
    const int64_t label = row.at("label");
    const std::string name = row.at("name");
    if (!labels_.insert(label).second) continue;
    tell(time_s, "label",
         "label " + std::to_string(label) + (name.empty() ? "" : " \"" + name + "\"") + " appeared");
  }
}

void Chronicle::hearEvents(const Json& events) {
  static const std::set<std::string> kinds{"lost", "back", "twin", "mission", "edit"};  // the rest is ours
  for (const Json& e : events.at("events")) {
    const std::string kind = e.at("kind"), who = e.at("node"), says = e.at("says");
    if (!kinds.contains(kind)) continue;
    const bool is_named = kind == "edit" || kind == "mission";  // its sentence says who
    const std::string text = is_named ? says : who + ": " + says;
    if (heard_.size() <= kMaxEvents && heard_.emplace(e.at("at_s"), kind, text).second)
      tell(e.at("at_s"), kind, text);
  }
}

Json Chronicle::tracks() const {
  Json tracks = Json::array();
  for (const auto& [name, life] : lives_) {
    if (life.points.empty()) continue;
    Json points = Json::array();
    for (const TrackPoint& p : life.points)
      points.push_back({rounded(p.time_s, 1e3), rounded(p.x, 1e3), rounded(p.y, 1e3), rounded(p.z, 1e3)});
    tracks.push_back({{"robot", name}, {"points", std::move(points)}});
  }
  return {{"tracks", std::move(tracks)}};
}

Json Chronicle::traffic() const {
  std::set<std::string> classes;
  for (const auto& [name, life] : lives_)
    for (const auto& [traffic, bytes] : life.sent)
      if (bytes > 0) classes.insert(traffic);
  Json nodes = Json::array();
  for (const auto& [name, life] : lives_) {
    Json bins = Json::array();
    for (const auto& [bin, sent] : life.bins) {
      Json row{rounded(static_cast<double>(bin) * bin_s_, 1e3)};
      for (const std::string& traffic : classes) {
        const auto bytes = sent.find(traffic);
        row.push_back(bytes == sent.end() ? 0 : bytes->second);
      }
      bins.push_back(std::move(row));
    }
    nodes.push_back({{"node", name}, {"budget", life.budget}, {"bins", std::move(bins)}});
  }
  return {{"bin_s", bin_s_}, {"classes", classes}, {"nodes", std::move(nodes)}};
}

Json Chronicle::events() const {
  std::vector<Event> sorted = events_;
  std::ranges::stable_sort(sorted, {}, &Event::time_s);
  Json events = Json::array();
  for (const Event& e : sorted)
    events.push_back({{"time_s", rounded(e.time_s, 1e3)}, {"kind", e.kind}, {"text", e.text}});
  return {{"events", std::move(events)}};
}

}  // namespace shoal::console
