// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "fusion_node/authentication.h"
#include "fusion_node/link.h"
#include "fusion_node/mission_keys.h"
#include "fusion_node/moment.h"
#include "fusion_node/process.h"
#include "robot_agent/agent.h"
#include "robot_agent/camera_stream.h"
#include "robot_agent/lone_robot.h"
#include "shoal/comms/camera_channels.h"
#include "shoal/comms/lcm_bus.h"
#include "shoal/comms/lcm_url.h"
#include "shoal/comms/rate_limited_bus.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/library.h"
#include "shoal/number_check.h"
#include "shoal/robot/known_topics_file.h"
#include "shoal/version.h"
#include "shoal/world/place.h"

namespace {

using namespace shoal;  // NOLINT: a main file

struct Flags {
  std::string robot = "R00", source, url = comms::kDefaultUrl, rate = "1", mission = "shoal",
              log_level = "info";
  std::string sigma = "auto", link = "clean", checkpoint, camera, source_url, key, bootstrap;
  double source_timeout_s = 0, start_s = 0;
  int64_t source_start_us = -1;
  bool period_given = false;
  bool single = false;
  world::SurveyOptions survey;
  robot_agent::AgentOptions agent;
};

/// What a robot sees, and what it needs for that.
struct Source {
  std::unique_ptr<comms::LcmBus> cameras;
  std::unique_ptr<world::Place> place;
  std::unique_ptr<world::ObservationSource> source;  // the last, for it uses the others
  double cell_size_m = 0;
  std::string what;
};

constexpr std::string_view kLive = "lcm:";
bool isLive(const Flags& flags) { return flags.source.starts_with(kLive); }

/// A real robot's cameras.
Source openLive(const Flags& flags, int robot) {
  const auto need = [&flags](bool there, const std::string& what) {
    if (!there) throw std::invalid_argument("--source " + flags.source + " needs " + what);
  };
  need(!flags.camera.empty(), "--camera FILE, for the intrinsics are in none of the messages");
  need(flags.survey.cell_size_m > 0, "--cell-size-m, the same for the whole team");
  need(!flags.single, "a robot of its own: --single flies worlds and recordings");
  if (!(flags.source_timeout_s >= 0)) throw std::invalid_argument("--source-timeout-s must be >= 0");
  const std::string prefix = flags.source.substr(kLive.size());
  world::LiveOptions options;
  options.camera = world::readCamera(flags.camera);
  options.altitude_m = flags.survey.altitude_m;
  options.max_observations = flags.survey.observations;
  options.min_period_s = flags.period_given ? flags.survey.frame_period_s : 0.0;
  if (flags.source_start_us >= 0) options.start = world::Timestamp{flags.source_start_us};
  Source from;
  comms::LcmBusOptions bus;
  bus.channels = comms::CameraChannels(prefix).all();
  bus.max_queue = 256;
  bus.max_message_bytes = wire::kMaxCameraBytes;
  from.cameras =
      std::make_unique<comms::LcmBus>(flags.source_url.empty() ? flags.url : flags.source_url, bus);
  from.source = world::withSensors(
      std::make_unique<robot_agent::CameraStream>(*from.cameras, prefix, options, flags.source_timeout_s),
      flags.survey.sensors, robot, flags.agent.explorer.seed);
  from.cell_size_m = flags.survey.cell_size_m;
  from.what = "what " + prefix + "_IMAGE, _DEPTH, _IMAGES and _POSE say on " + from.cameras->url();
  return from;
}

/// A world or a recording.
Source openPlace(Flags flags, int robot) {
  std::optional<world::Camera> camera;
  if (!flags.camera.empty()) {
    camera = world::readCamera(flags.camera);
    flags.survey.intrinsics = camera->intrinsics;
  }
  Source from;
  from.place = world::openPlace(flags.source, flags.agent.explorer.seed, camera);
  const world::SurveyOptions team = from.place->completed(flags.survey);
  from.cell_size_m = team.cell_size_m;
  from.source = from.place->source(team, robot, flags.single);
  from.what =
      std::to_string(from.source->numObservations().value_or(0)) + " observations over " + from.place->name();
  return from;
}

void sayTroubles(const world::ObservationSource& source) {
  if (const std::string troubles = source.troubles(); !troubles.empty())
    spdlog::warn("left out: {}", troubles);
}

/// Of a robot that has its checkpoint, so a disk that is full may do without.
void keepEpoch(const std::string& path, int32_t epoch) {
  const std::string text = std::to_string(epoch) + "\n";
  try {
    if (!std::filesystem::exists(path) || mapping::readFile(path) != text)
      mapping::writeFileAtomically(path, text);
  } catch (const std::runtime_error& error) {
    spdlog::warn("{}", error.what());
  }
}

/// The robot as it was when it last wrote a checkpoint; in a new epoch when it has lost that and knows that
/// it had one.
void resume(Flags& flags, world::RobotId id) {
  robot_agent::AgentOptions& options = flags.agent;
  options.checkpoint_dir = flags.checkpoint;
  const std::string path = robot_agent::checkpointPath(flags.checkpoint, id);
  const std::string epoch_path = robot_agent::epochPath(flags.checkpoint, id);
  robot_agent::removeUnfinished(path);
  std::optional<robot_agent::Checkpoint> checkpoint;
  try {
    checkpoint = robot_agent::readCheckpoint(path);
  } catch (const std::runtime_error& error) {
    spdlog::error("{}; it begins anew", error.what());
  }
  if (checkpoint && checkpoint->epoch < options.explorer.epoch) checkpoint.reset();  // told to begin anew
  if (checkpoint && (checkpoint->mission != options.mission || checkpoint->robot != id)) {
    throw std::invalid_argument("--checkpoint " + flags.checkpoint + " holds another mission (" +
                                std::to_string(checkpoint->mission) + "); name another folder");
  }
  if (checkpoint) {
    options.explorer.epoch = checkpoint->epoch;
    keepEpoch(epoch_path, checkpoint->epoch);
    const fusion_node::Gap gap = fusion_node::passedBetween(checkpoint->saved, fusion_node::thisMoment());
    if (!gap.doubt.empty()) spdlog::warn("{}: {}; goes on from the time in it", path, gap.doubt);
    const double passed_us = options.rate * static_cast<double>(gap.us);
    options.start_us =
        std::max({options.start_us, checkpoint->mission_us + static_cast<int64_t>(std::llround(passed_us)),
                  int64_t{1}});
    options.resume = std::move(checkpoint);
  } else if (const auto before = robot_agent::readEpoch(epoch_path)) {
    options.explorer.epoch = std::max(options.explorer.epoch, *before + 1);
    spdlog::warn("the checkpoint of epoch {} is lost: epoch {} begins", *before, options.explorer.epoch);
  }
}

int run(Flags flags) {
  robot_agent::AgentOptions& options = flags.agent;
  const auto id = world::parseRobotId(flags.robot);
  if (!id) throw std::invalid_argument("robot \"" + flags.robot + "\" should be R00, R01, ... R9999");
  if (number(*id) >= flags.survey.num_robots && !flags.single && !isLive(flags)) {
    throw std::invalid_argument("robot " + flags.robot + " is not of a team of " +
                                std::to_string(flags.survey.num_robots) + "; raise --robots");
  }
  if (*id == mapping::kLibrary)
    throw std::invalid_argument("R9999 is the library of names; robots are R00 to R9998");
  options.explorer.robot = *id;
  options.mission = fusion_node::missionId(flags.mission);
  options.rate = fusion_node::parseRate(flags.rate);
  options.start_us = std::llround(flags.start_s * 1e6);
  options.live = isLive(flags);
  options.has_mission_time = flags.source_start_us >= 0;
  options.team_size = flags.survey.num_robots;
  for (const std::string& folder : {options.out_dir, flags.checkpoint})
    if (!folder.empty()) mapping::makeFolder(folder);
  if (!flags.checkpoint.empty()) resume(flags, *id);
  options.matcher.sigma = matching::parseSigma(flags.sigma);
  if (!flags.bootstrap.empty()) {
    options.explorer.known = robot::readKnownTopics(flags.bootstrap, options.explorer.profile);
    spdlog::info("{} begins with {} topics of {}", flags.robot, options.explorer.known.size(),
                 flags.bootstrap);
  }

  const comms::LinkModel model = comms::readLink(flags.link);

  const Source from = isLive(flags) ? openLive(flags, number(*id)) : openPlace(flags, number(*id));
  options.explorer.cell_size_m = from.cell_size_m;
  if (flags.single) options.explorer.keeps_pictures = false;  // nobody to show them to
  world::ObservationSource& source = *from.source;
  if (flags.single) {
    robot_agent::runAlone(options.explorer, source, options.out_dir);
    sayTroubles(source);
    return 0;
  }
  const auto key = fusion_node::readKey(flags.key);
  comms::LcmBus air(flags.url);
  const auto sealed = fusion_node::authenticated(air, key);
  comms::RateLimitedBus heard(sealed ? static_cast<comms::Bus&>(*sealed) : air);
  const auto link = fusion_node::emulated(
      heard, model, {flags.robot, options.mission, options.explorer.seed, options.rate});
  spdlog::info("{} flies {}, mission {}, on {}, link {}", flags.robot, from.what, options.mission, air.url(),
               flags.link);
  robot_agent::Agent(options, source, link ? static_cast<comms::Bus&>(*link) : heard).run();
  fusion_node::logLink(link.get());
  fusion_node::logAuthentication(sealed.get());
  sayTroubles(source);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  Flags f;
  f.agent.explorer.keeps_pictures = true;
  CLI::App app{"One robot: explores, invents labels, and tells the others under a byte budget.",
               "robot_agent"};
  app.set_version_flag("--version", std::string("robot_agent ") + version() + " (" + commit() + ")");
  app.set_config("--config", "", "mission.toml: any of these flags");
  app.allow_config_extras(CLI::config_extras_mode::ignore_all);  // the file serves other programs too
  app.footer(
      "  robot_agent --robot R00 --robots 3 --source reef:varied --mission bay --out out\n"
      "  robot_agent --robot R03 --robots 12 --source lcm:CAM --lcm-url 'udpm://239.255.76.67:7667?ttl=1' "
      "--mission bay --out out");
  app.add_option("--robot", f.robot, "R00, R01, ...")->capture_default_str();
  app.add_option("--source", f.source,
                 "reef:sparse, reef:varied, reef:tuning, a world folder, a recording, or lcm:PREFIX (a real "
                 "robot's cameras)")
      ->required();
  app.add_option("--robots", f.survey.num_robots,
                 "robots that share the area; robot k flies share k, and waits for all after landing")
      ->check(CLI::Range(1, 10000))
      ->capture_default_str();
  app.add_option("--observations", f.survey.observations, "images to take, 0 = as many as cover the share")
      ->check(CLI::Range(0, 10'000'000))
      ->capture_default_str();
  app.add_option("--seed", f.agent.explorer.seed, "mission seed")->capture_default_str();
  app.add_option("--lcm-url", f.url, "multicast group of the link")
      ->envname("SHOAL_LCM_URL")
      ->capture_default_str();
  app.add_option("--budget", f.agent.budget, "bytes per second of mission time on the link, 0 = unlimited")
      ->check(CLI::Range(int64_t{0}, int64_t{INT32_MAX}))
      ->capture_default_str();
  app.add_option("--link", f.link,
                 "emulated on the receiving side: clean, mesh, acoustic, satellite or a file")
      ->capture_default_str();
  app.add_option("--key", f.key, "file with the team's key: only who has it is listened to");
  app.add_option("--profile", f.agent.explorer.profile, "words and hyper-parameters: best or paper")
      ->capture_default_str();
  app.add_option("--bootstrap", f.bootstrap, "topics.json of an earlier mission: topics to begin with")
      ->check(CLI::ExistingFile);
  app.add_option("--detail", f.agent.explorer.detail,
                 "of topics and certainties on the link: fine, or coarse for fewer bytes")
      ->transform(CLI::CheckedTransformer(std::map<std::string, mapping::Detail>{
          {"fine", mapping::Detail::kFine}, {"coarse", mapping::Detail::kCoarse}}))
      ->default_str("fine");
  app.add_option("--mission", f.mission, "number or name that all processes of a mission share")
      ->capture_default_str();
  app.add_option("--rate", f.rate, "mission seconds per wall second: 1, 10, or max")->capture_default_str();
  app.add_option("--cell-size-m", f.survey.cell_size_m, "edge of a cell, m (default: the world's)")
      ->check(moreThanZero);
  app.add_option(
         "--altitude-m", f.survey.altitude_m,
         "camera height, m (default: native resolution); of a recording without depth, above a flat floor")
      ->check(moreThanZero);
  app.add_option("--camera", f.camera, "camera.json with the intrinsics (default: the world's usual)");
  auto* period =
      app.add_option("--frame-period-s", f.survey.frame_period_s,
                     "mission seconds between images; of lcm:PREFIX the least (default: every one)")
          ->check(moreThanZero)
          ->capture_default_str();
  app.add_option("--source-url", f.source_url,
                 "lcm:PREFIX: multicast group of the cameras (default: the link's)");
  app.add_option("--source-timeout-s", f.source_timeout_s,
                 "lcm:PREFIX: land after so many seconds without an image, 0 = never")
      ->capture_default_str();
  app.add_option("--source-start-us", f.source_start_us,
                 "lcm:PREFIX: the utime that is mission time 0 (default: of the first image)")
      ->check(zeroOrMore);
  app.add_option("--exposure", f.survey.sensors.exposure, "robots differ in brightness by up to 1 + this")
      ->capture_default_str();
  app.add_option("--color-cast", f.survey.sensors.color_cast,
                 "robots differ in each colour by up to this part")
      ->capture_default_str();
  app.add_option("--pose-drift", f.survey.sensors.pose_drift,
                 "dead reckoning's error, m per square root of a metre flown")
      ->capture_default_str();
  app.add_option("--depth-noise", f.survey.sensors.depth_noise, "standard deviation of depth over depth")
      ->capture_default_str();
  app.add_option("--depth-holes", f.survey.sensors.depth_holes, "part of the depth that is missing")
      ->capture_default_str();
  app.add_option("--out", f.agent.out_dir, "folder for robots/RNN/{map.csv,topics.json,poses.txt}");
  app.add_flag("--fuse", f.agent.fuse, "hold everybody's beliefs and fuse them on board too");
  auto* matcher = app.add_option("--matcher", f.agent.matcher.matcher,
                                 "for --fuse and to look again: id, hungarian, clear or shoal");
  auto* similarity = app.add_option("--similarity", f.agent.matcher.similarity,
                                    "of --matcher: cosine, overlap, l1, l2 or discounted");
  app.add_option(
         "--sigma", f.sigma,
         "of --matcher: least similarity of a match: auto (the matcher's usual) or a number in (0, 1]")
      ->capture_default_str();
  app.add_option("--epoch", f.agent.explorer.epoch,
                 "how often this robot has begun anew: what it said in earlier epochs is void")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  app.add_option("--start-s", f.start_s, "mission time at which the flight begins, after a restart")
      ->check(CLI::Range(0.0, 1e9))
      ->capture_default_str();
  app.add_flag("!--no-pictures", f.agent.explorer.keeps_pictures,
               "keep and send no pictures of what topics look like");
  app.add_flag("!--no-look-again", f.agent.looks_again,
               "when all have landed do not look again at the map with what the team knows");
  app.add_flag("--linger", f.agent.linger, "stay after landing until told to stop");
  app.add_flag("--single", f.single, "fly everybody's shares alone, off the link, into --out itself");
  app.add_option("--checkpoint", f.checkpoint,
                 "folder in which the robot's mind is kept: started again with it, it goes on");
  app.add_option("--log-level", f.log_level, "trace, debug, info, warn, error or off")->capture_default_str();
  matcher->capture_default_str();
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    fusion_node::setUpLog(f.single ? "single" : f.robot, f.log_level);
    for (const std::string& typo : fusion_node::likelyTypos(app)) spdlog::warn("{}", typo);
    fusion_node::catchStopSignals();
    f.period_given = period->count() > 0;
    if (similarity->count() == 0)
      f.agent.matcher.similarity = matching::usualSimilarity(f.agent.matcher.matcher);
    return run(std::move(f));
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "robot_agent: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return 1;
  }
}
