// SPDX-License-Identifier: BSD-3-Clause
#include <chrono>
#include <cstdio>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "fusion_node/mission_file.h"
#include "operator_console/command.h"
#include "operator_console/spy.h"
#include "operator_console/stop_signal.h"
#include "operator_console/terminal.h"
#include "shoal/comms/lcm_bus.h"
#include "shoal/comms/lcm_url.h"
#include "shoal/comms/log_reader.h"

namespace shoal::console {
namespace {

struct SpyFlags {
  std::string lcm_url = comms::kDefaultUrl, log, channel;
  bool once = false, json = false;
  double seconds = 3;
};

bool show(const SpyFlags& flags, const Spy& spy, double now_s) {
  if (flags.json) {
    std::cout << spy.json(now_s).dump(flags.once ? 2 : -1) << '\n';
  } else {
    if (!flags.once) clearTerminal();
    std::cout << spy.text(now_s, isOnTerminal());
  }
  return static_cast<bool>(std::cout.flush());
}

int spyOnLog(SpyFlags flags, Spy& spy) {
  flags.once = true;
  double latest_s = 0;
  bool is_heard = false;
  const auto hearAll = [&](auto log) {
    while (const auto event = log.next()) {
      const double at_s = static_cast<double>(event->time_us) * 1e-6;
      latest_s = std::max(latest_s, at_s);
      spy.hear(event->packet, at_s);
      is_heard = true;
    }
  };
  if (fusion_node::isSqlite(flags.log)) {
    hearAll(fusion_node::MissionFileReader(flags.log));
  } else {
    hearAll(comms::LogReader(flags.log));
  }
  if (!is_heard) throw std::runtime_error(flags.log + " holds no message; is it an LCM log?");
  show(flags, spy, latest_s);
  return 0;
}

int spyOnAir(const SpyFlags& flags, Spy& spy) {
  comms::LcmBusOptions options;
  options.everything = true;
  options.max_message_bytes = size_t{1} << 28;
  options.max_queue = 4096;
  comms::LcmBus bus(flags.lcm_url, options);
  catchStopSignals();
  const auto start = std::chrono::steady_clock::now();
  const auto now_s = [start] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  const double period_s = flags.once ? flags.seconds : 1;
  bool heard = false;
  for (double next_s = period_s; stopSignal() == 0;) {
    heard |= bus.receive(50, [&](const comms::Packet& packet) { spy.hear(packet, now_s()); }) > 0;
    if (now_s() < next_s) continue;
    if (!show(flags, spy, now_s())) break;  // nobody reads any more
    if (flags.once) break;
    next_s += period_s;
  }
  return heard || !flags.once ? 0 : 1;
}

int spy(const SpyFlags& flags) {
  std::optional<std::regex> shown;
  if (!flags.channel.empty()) {
    try {
      shown.emplace(flags.channel, std::regex::ECMAScript | std::regex::optimize);
    } catch (const std::regex_error&) {
      throw std::invalid_argument("--channel \"" + flags.channel +
                                  "\" is no regular expression; SHOAL_R0[0-3]_.* is");
    }
  }
  Spy spy(std::move(shown), !flags.log.empty());
  return flags.log.empty() ? spyOnAir(flags, spy) : spyOnLog(flags, spy);
}

}  // namespace

void addSpyCommand(CLI::App& app, Action& chosen) {
  CLI::App* command =
      app.add_subcommand("spy", "what is said on the link: channels, rates, bytes, decoded messages");
  const auto flags = std::make_shared<SpyFlags>();
  auto* url = command->add_option("--lcm-url", flags->lcm_url, "multicast group to listen to")
                  ->envname("SHOAL_LCM_URL")
                  ->capture_default_str();
  auto* log = command->add_option("--log", flags->log, "a recording made by lcm-logger instead");
  command->add_option(
      "--channel", flags->channel,
      "only channels that match this regular expression as a whole; decodes the last message of each");
  command->add_flag("--once", flags->once, "say it once and end; exit 1 when nothing was heard");
  command->add_option("--seconds", flags->seconds, "how long to listen with --once")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->add_flag("--json", flags->json, "answer in JSON, without --once a line a second");
  command->footer(
      "Bytes are those on the wire, all headers counted. Rates of channels are of the last ten seconds (of "
      "a\n"
      "recording: of all of it); those of nodes are by mission time, as budgets are. bad: refused, for what "
      "we decode.\n\n"
      "  operator_console spy\n"
      "  operator_console spy --channel 'SHOAL_R03_HEARTBEAT' --once\n"
      "  operator_console spy --log runs/a/mission.lcmlog --json");
  command->callback([flags, url, log, &chosen] {
    if (log->count() > 0 && url->count() > 0) throw CLI::ExcludesError("--log", "--lcm-url");
    chosen = [flags] { return spy(*flags); };
  });
}

}  // namespace shoal::console
