// SPDX-License-Identifier: BSD-3-Clause
#include "fusion_node/process.h"

#include <unistd.h>

#include <array>
#include <charconv>
#include <csignal>
#include <stdexcept>

#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include "shoal/text_hash.h"

namespace shoal::fusion_node {
namespace {

volatile std::sig_atomic_t stop_requested = 0;

void onStopSignal(int) { stop_requested = 1; }

}  // namespace

void setUpLog(const std::string& node, const std::string& level) {
  const auto parsed = spdlog::level::from_str(level);
  if (parsed == spdlog::level::off && level != "off") {
    throw std::invalid_argument("log level \"" + level +
                                "\" should be trace, debug, info, warn, error or off");
  }
  spdlog::set_default_logger(spdlog::stderr_color_mt(node));
  spdlog::set_pattern("%Y-%m-%dT%H:%M:%S.%e %l %n: %v");
  spdlog::set_level(parsed);
  spdlog::flush_on(spdlog::level::info);
}

void catchStopSignals() {
  struct sigaction action {};
  action.sa_handler = onStopSignal;
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

bool stopRequested() { return stop_requested != 0; }

int32_t missionId(const std::string& text) {
  int32_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error == std::errc{} && end == text.data() + text.size() && number > 0) return number;
  return static_cast<int32_t>(hashText(text) % 0x7fffffffu) + 1;
}

int32_t hostHash() {
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  return static_cast<int32_t>(hashText(host.data()) & 0x7fffffffu);
}

double parseRate(const std::string& text) {
  if (text == "max") return 0.0;
  double rate = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), rate);
  if (error != std::errc{} || end != text.data() + text.size() || !(rate >= 0.001) || rate > 1000) {
    throw std::invalid_argument("rate \"" + text + "\" should be max or a number from 0.001 to 1000");
  }
  return rate;
}

}  // namespace shoal::fusion_node
