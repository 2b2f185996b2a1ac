// SPDX-License-Identifier: BSD-3-Clause
#include <cstdint>
#include <cstdio>
#include <exception>
#include <memory>
#include <stdexcept>

#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "fusion_node/authentication.h"
#include "fusion_node/link.h"
#include "fusion_node/mission_keys.h"
#include "fusion_node/node.h"
#include "fusion_node/process.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/lcm_bus.h"
#include "shoal/comms/lcm_url.h"
#include "shoal/comms/rate_limited_bus.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/number_check.h"
#include "shoal/version.h"
#include "shoal/world/ids.h"

namespace {

using namespace shoal;  // NOLINT: a main file

struct Link {
  std::string url = comms::kDefaultUrl, model = "clean", key;
  uint64_t seed = 1;
};

int run(fusion_node::NodeOptions options, const Link& on) {
  const comms::LinkModel model = comms::readLink(on.model);
  const auto key = fusion_node::readKey(on.key);
  comms::LcmBus air(on.url);
  const auto sealed = fusion_node::authenticated(air, key);
  comms::RateLimitedBus heard(sealed ? static_cast<comms::Bus&>(*sealed) : air);
  const auto emulated =
      fusion_node::emulated(heard, model, {options.name, options.mission, on.seed, options.rate});
  std::unique_ptr<comms::LcmBus> local;
  if (comms::localUrl(on.url) != comms::composeUrl(comms::parseUrl(on.url))) {
    local = std::make_unique<comms::LcmBus>(comms::localUrl(on.url));
  }
  const auto sealed_local = local ? fusion_node::authenticated(*local, key) : nullptr;
  options.authentication = sealed.get();
  comms::Bus* said_here = local ? static_cast<comms::Bus*>(local.get()) : &heard;
  if (sealed_local) said_here = sealed_local.get();
  fusion_node::Node node(options, emulated ? static_cast<comms::Bus&>(*emulated) : heard, *said_here);
  spdlog::info("listening on {}, link {}, mission {}, matcher {}", air.url(), on.model, options.mission,
               options.matcher.matcher);
  while (!fusion_node::stopRequested()) {
    node.turn(20);
    if (local) local->receive(0, [](const comms::Packet&) {});  // only spoken to: else its queue would grow
  }
  node.finish();
  fusion_node::logLink(emulated.get());
  fusion_node::logAuthentication(sealed.get());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  fusion_node::NodeOptions options;
  Link link;
  std::string rate = "1", mission = "shoal", log_level = "info", sigma = "auto", library;
  CLI::App app{"Hears a team of robots, matches their labels and republishes one consistent map.",
               "fusion_node"};
  app.set_version_flag("--version", std::string("fusion_node ") + version() + " (" + commit() + ")");
  app.set_config("--config", "", "mission.toml: any of these flags");
  app.allow_config_extras(CLI::config_extras_mode::ignore_all);  // the file serves other programs too
  app.footer(
      "  fusion_node --node OPERATOR --mission bay --state state --out out\n"
      "  fusion_node --node BOAT --lcm-url 'udpm://239.255.76.67:7667?ttl=1' --budget 500 --mission bay "
      "--state state");
  app.add_option("--node", options.name, "name of this node, capitals and digits")->capture_default_str();
  app.add_option("--lcm-url", link.url, "multicast group of the link")
      ->envname("SHOAL_LCM_URL")
      ->capture_default_str();
  app.add_option("--budget", options.budget, "bytes per second of mission time on the link, 0 = unlimited")
      ->check(CLI::Range(int64_t{0}, int64_t{INT32_MAX}))
      ->capture_default_str();
  app.add_option("--key", link.key, "file with the team's key: only who has it is listened to");
  app.add_option("--link", link.model,
                 "emulated on the receiving side: clean, mesh, acoustic, satellite or a file")
      ->capture_default_str();
  app.add_option("--seed", link.seed, "mission seed: decides what the emulated link loses")
      ->capture_default_str();
  app.add_option("--matcher", options.matcher.matcher,
                 "id, hungarian, incremental, components, clear or shoal")
      ->capture_default_str();
  auto* similarity =
      app.add_option("--similarity", options.matcher.similarity,
                     "cosine, overlap, l1, l2, hellinger, js or discounted (default: the matcher's usual)");
  app.add_option("--sigma", sigma,
                 "least similarity of a match: auto (the matcher's usual) or a number in (0, 1]")
      ->capture_default_str();
  app.add_option("--mission", mission, "number or name that all processes of a mission share")
      ->capture_default_str();
  app.add_option("--rate", rate, "mission seconds per wall second: 1, 10, or max = as the robots")
      ->capture_default_str();
  app.add_option("--cell-size-m", options.cell_size_m, "edge of a cell, m, until a robot has said")
      ->check(moreThanZero)
      ->capture_default_str();
  app.add_option(
         "--library", library,
         "names of missions before, from `operator_console library save`: what is known arrives named")
      ->check(CLI::ExistingFile);
  app.add_option("--state", options.state_dir, "folder in which the node answers `operator_console --node`");
  app.add_option("--out", options.out_dir, "folder for global_map.csv and labels.csv at the end");
  app.add_option("--log-level", log_level, "trace, debug, info, warn, error or off")->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    fusion_node::setUpLog(options.name, log_level);
    for (const std::string& typo : fusion_node::likelyTypos(app)) spdlog::warn("{}", typo);
    fusion_node::catchStopSignals();
    options.mission = fusion_node::missionId(mission);
    options.rate = fusion_node::parseRate(rate);
    options.matcher.sigma = matching::parseSigma(sigma);
    if (similarity->count() == 0)
      options.matcher.similarity = matching::usualSimilarity(options.matcher.matcher);
    if (!library.empty()) options.library = mapping::parseLibrary(mapping::readFile(library), library);
    comms::channelName(options.name, "HEARTBEAT");  // a bad node name is a bad flag
    if (world::parseRobotId(options.name))
      throw std::invalid_argument("--node " + options.name +
                                  " is the name of a robot; name it otherwise, as OPERATOR");
    if (!options.out_dir.empty()) mapping::makeFolder(options.out_dir);
    return run(options, link);
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "fusion_node: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return 1;
  }
}
