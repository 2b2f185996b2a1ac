// SPDX-License-Identifier: BSD-3-Clause
#include <unistd.h>

#include <array>
#include <chrono>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <thread>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "fusion_node/process.h"
#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/serve/api.h"
#include "operator_console/serve/foxglove_server.h"

namespace shoal::console {
namespace {

struct Serving {
  Asking asking;
  HttpOptions http;
  TruthHint hint;
  bool read_only = false;
  std::optional<uint16_t> foxglove;  // port
  std::vector<std::string> origins;
};

std::string hostName() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "localhost";
}

int serve(const Serving& flags) {
  fusion_node::catchStopSignals();
  const Where where = whereOf(flags.asking);
  const Gate gate{flags.read_only ? std::string() : freshToken(), hostName()};
  // Each is told of the other once both are there.
  std::mutex mutex;
  Api* api = nullptr;
  HttpServer* server = nullptr;
  std::optional<MissionFeed> feed;
  feed.emplace(where, [&] {
    const std::lock_guard lock(mutex);
    if (server != nullptr) server->publish(api->news());
  });
  const auto now = std::chrono::system_clock::now().time_since_epoch();
  TruthLayer truth(where, flags.hint);
  Api answers(where, *feed, truth, gate,
              static_cast<uint64_t>(std::chrono::duration_cast<std::chrono::microseconds>(now).count()));
  HttpServer http(flags.http, [&answers](const HttpRequest& request) { return answers.answer(request); });
  {
    const std::lock_guard lock(mutex);
    api = &answers;
    server = &http;
  }
  std::optional<FoxgloveServer> foxglove;
  if (flags.foxglove)
    foxglove.emplace(FoxgloveOptions{flags.http.host, *flags.foxglove, flags.origins}, gate, *feed);
  const std::string looks =
      foxglove ? fmt::format("ws://{}:{}", flags.http.host == "0.0.0.0" ? hostName() : flags.http.host,
                             foxglove->port())
               : "";
  const std::string url =
      fmt::format("http://{}:{}/{}", flags.http.host == "0.0.0.0" ? hostName() : flags.http.host, http.port(),
                  gate.token.empty() ? "" : "#token=" + gate.token);
  if (flags.asking.json) {
    nlohmann::ordered_json said{{"url", url}, {"port", http.port()}, {"token", gate.token}};
    if (foxglove) said["foxglove"] = looks;
    std::cout << said.dump() << std::endl;
  } else {
    fmt::print("The mission is at {}\n", url);
    if (foxglove) fmt::print("Foxglove and Lichtblick open a connection to {}\n", looks);
    fmt::print("Ctrl-C ends this.\n");
    std::fflush(stdout);
  }
  while (!fusion_node::stopRequested()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  {
    const std::lock_guard lock(mutex);
    server = nullptr;
  }
  foxglove.reset();
  feed.reset();
  return 0;
}

}  // namespace

void addServeCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("serve", "the mission as a page for browsers");
  const auto flags = std::make_shared<Serving>();
  addWhere(*command, flags->asking);
  command->add_option("--port", flags->http.port, "where to listen; 0: any free port")->capture_default_str();
  command
      ->add_option("--host", flags->http.host,
                   "address of this machine to listen on; 0.0.0.0: all of them, for anybody who can reach it")
      ->capture_default_str();
  command->add_option(
      "--world", flags->hint.world,
      "where the mission takes place, for the layer \"truth\"; a finished run says it itself");
  command->add_option("--seed", flags->hint.seed, "of the mission, for --world with --node and --log")
      ->capture_default_str();
  command->add_flag("--read-only", flags->read_only, "nobody may name, link or exclude");
  command->add_option(
      "--foxglove", flags->foxglove,
      "also listen on this port for Foxglove and Lichtblick (usually 8765; 0: any free port)");
  command
      ->add_option("--foxglove-origin", flags->origins,
                   "a site whose pages may look through that port, such as https://app.foxglove.dev; "
                   "programs need none")
      ->allow_extra_args(false);
  command->footer(
      "The URL that is printed holds a token; who opens the page without it can look, and change nothing.\n"
      "What the page asks is described in /openapi.json, and is there for scripts too.\n\n"
      "  operator_console serve --node state\n"
      "  operator_console serve --run runs/a --port 8081 --read-only\n"
      "  operator_console serve --node state --foxglove 8765\n"
      "  curl -s 'http://127.0.0.1:8080/api/area?label=10004&min_m2=3'");
  command->callback([flags, &chosen] { chosen = [flags] { return serve(*flags); }; });
}

}  // namespace shoal::console
