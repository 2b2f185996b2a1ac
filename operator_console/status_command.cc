// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <thread>

#include <spdlog/spdlog.h>

#include "fusion_node/process.h"
#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/silence.h"
#include "operator_console/terminal.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct StatusQuestion {
  Asking asking;
  bool watch = false, where = false;
  double every_s = 2;
};

// What was sent of what might have been, since mission time 0.
std::string budgetUsed(const Json& n) {
  const double allowed = n["budget"].get<double>() * n["heard_s"].get<double>();
  return allowed > 0 ? fmt::format("{:.0f}%", 100 * n["bytes_sent"].get<double>() / allowed) : "-";
}

// How long it takes to say what waits.
std::string timeToClear(const Json& n) {
  return n["budget"].get<int64_t>() == 0 ? "-" : fmt::format("{:.0f}", n["clear_s"].get<double>());
}

// What of it arrives, in percent; of who is silent, nothing does.
std::string linkQuality(const Json& n) {
  if (n["silent"].get<bool>()) return "-";
  const auto share = n.find("heard_share");
  return share == n.end() || share->is_null() ? "-" : fmt::format("{:.0f}", 100 * share->get<double>());
}

void printRow(const Json& n) {
  const bool flies = n["phase"] != "node";
  const std::string images =
      fmt::format("{}/{}", n["observation"].get<int>() + 1, n["num_observations"].get<int>());
  const std::string told = !flies ? "-" : n["heard_whole"].get<bool>() ? "all" : "part";
  const std::string agreement = n["agreement"];
  const bool is_silent = n["silent"].get<bool>();
  const std::string phase = fmt::format("{:<9}", is_silent ? "silent" : n["phase"].get<std::string>());
  fmt::print("{:<8} {} {:>5.0f} {:>7} {:>6} {:>6} {:>4} {:>4} {:>5} {:>5} {:<4} {}\n",
             n["name"].get<std::string>(), is_silent ? alarming(phase) : phase, n["ago_s"].get<double>(),
             flies ? images : "-", n["topics"].get<int>(), n["cells"].get<int>(), linkQuality(n),
             budgetUsed(n), n["queue_bytes"].get<int>(), timeToClear(n), told,
             agreement == "none"    ? "-"
             : agreement == "other" ? alarming("OTHER")
                                    : agreement);
}

// Messages that nodes refused, in lines of 80 columns; nothing when there are none.
void printRefused(const Json& a) {
  std::string line = "refused:";
  for (const Json& n : a["nodes"]) {
    if (n["rejected"].get<int>() == 0) continue;
    const std::string item = fmt::format(" {} {}", n["name"].get<std::string>(), n["rejected"].get<int>());
    if (line.size() + item.size() > 80) {
      fmt::print("{}\n", line);
      line = std::string(8, ' ');
    }
    line += item;
  }
  if (line != "refused:") fmt::print("{}\n", line);
}

// Where everybody is, and what their vehicles say of themselves.
void printPlaces(const Json& a) {
  fmt::print("\n{:<8} {:>8} {:>8} {:>8} {:>8} {:>8} {:>9}\n", "node", "x m", "y m", "z m", "depth m",
             "battery", "ms/image");
  for (const Json& n : a["nodes"]) {
    if (n["phase"] == "node") continue;
    const Json& p = n["position_m"];
    const auto known = [&n](const char* key, const char* unit) {
      const auto found = n.find(key);
      return found == n.end() || found->is_null() ? "-" : fmt::format("{}{}", found->get<double>(), unit);
    };
    fmt::print("{:<8} {:>8.1f} {:>8.1f} {:>8.1f} {:>8} {:>8} {:>9.1f}\n", n["name"].get<std::string>(),
               p[0].get<double>(), p[1].get<double>(), p[2].get<double>(), known("depth_m", ""),
               known("battery_percent", " %"), n["ms_per_frame"].get<double>());
  }
}

void print(const Json& a) {
  if (const double silent_s = a.value("silent_s", 0.0); silent_s > 5) {
    spdlog::warn("the node has heard nobody else for {:.0f} s", silent_s);
  }
  fmt::print("mission {} at {:.1f} s: {} cells, {} labels, cells of {} m\n", a["mission_id"].get<int64_t>(),
             latestHeard(a["nodes"]), a["cells"].get<int64_t>(), a["labels"].get<int64_t>(),
             a["cell_size_m"].get<double>());
  fmt::print("state {}, map {}\n", a["digest"]["state"].get<std::string>(),
             a["digest"]["map"].get<std::string>());
  if (const auto library = a.find("library"); library != a.end()) {
    fmt::print("library of {} names, digest {}{}\n", (*library)["names"].get<int>(),
               (*library)["digest"].get<std::string>(),
               (*library)["differs"].get<bool>()
                   ? alarming(", NOT THE ONE THIS NODE WAS GIVEN: " + (*library)["given"].get<std::string>())
                   : "");
  }
  fmt::print("{:<8} {:<9} {:>5} {:>7} {:>6} {:>6} {:>4} {:>4} {:>5} {:>5} {:<4} {}\n", "node", "phase",
             "ago s", "images", "topics", "cells", "link", "used", "queue", "clear", "told", "map");
  for (const Json& n : a["nodes"]) printRow(n);
  printRefused(a);
  for (const Json& m : a["mixed"])
    fmt::print("{:<8} {}: {}\n", m["node"].get<std::string>(), alarming(m["kind"].get<std::string>()),
               m["says"].get<std::string>());
  for (const Json& s : a["strangers"]) {
    fmt::print("{:<8} {} has {}: {} messages\n", s["name"].get<std::string>(), alarming("stranger"),
               s["has"].get<std::string>(), s["messages"].get<uint64_t>());
  }
}

int status(const StatusQuestion& q) {
  if (q.watch) fusion_node::catchStopSignals();
  do {
    Json a = answerTo(q.asking, {{"query", "status"}});
    addSilence(q.asking, a["nodes"], latestHeard(a["nodes"]));
    if (q.watch) clearTerminal();
    if (q.asking.json) {
      std::cout << a.dump(q.watch ? -1 : 2) << '\n';
    } else {
      print(a);
      if (q.where) printPlaces(a);
    }
    if (!std::cout.flush() || std::fflush(stdout) != 0) break;  // nobody reads any more
    const auto until = std::chrono::steady_clock::now() + std::chrono::duration<double>(q.every_s);
    while (q.watch && !fusion_node::stopRequested() && std::chrono::steady_clock::now() < until) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  } while (q.watch && !fusion_node::stopRequested());
  return 0;
}

}  // namespace

void addStatusCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("status", "how every node of a mission is doing");
  const auto q = std::make_shared<StatusQuestion>();
  addWhere(*command, q->asking);
  command->add_flag("--where", q->where,
                    "also where each is, its depth, its battery, its milliseconds an image");
  auto* watch =
      command->add_flag("--watch", q->watch, "ask again and again until Ctrl-C; with --json a line each");
  command->add_option("--every", q->every_s, "seconds between two looks")
      ->needs(watch)
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->footer(
      "silent: lost, as events tells it, and not heard since; of a finished mission and of a recording only\n"
      "robots that had not landed. ago: mission time since a node was last heard. link: percent of the\n"
      "bytes a node sent in its last minute that arrived here. used: bytes sent, in all its lives that\n"
      "were heard, of what the budget allowed so far. queue: bytes that wait. clear: seconds until they\n"
      "are said, if nothing new comes. refused: messages not understood, or too many at once.\n"
      "told: whether all that a robot has to say was heard. map: the same as this one, made of another\n"
      "state (behind), or OTHER though made of the same state: an alarm, unless a recording was asked with\n"
      "another --matcher than the mission's. Below the table: clocks that are off, twins, other missions, "
      "other\n"
      "settings, each a line. A stranger speaks without the key that this node has, or with "
      "a\n"
      "key that it lacks.\n\n"
      "  operator_console status --node state --watch\n"
      "  operator_console status --run runs/a --where");
  command->callback([q, &chosen] {
    chosen = [q] {
      if (q->watch && !q->asking.where.run.empty()) {
        throw std::invalid_argument("--watch is for --node and --log: a finished run does not change");
      }
      return status(*q);
    };
  });
}

}  // namespace shoal::console
