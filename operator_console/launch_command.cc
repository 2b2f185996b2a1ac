// SPDX-License-Identifier: BSD-3-Clause
#include <memory>
#include <stdexcept>
#include <string>

#include "fusion_node/process.h"
#include "operator_console/command.h"
#include "operator_console/launch.h"

namespace shoal::console {
namespace {

struct LaunchFlags {
  LaunchOptions launch;
  std::string sigma = "auto";
  std::string similarity;  // empty: the one that goes with the matcher
};

}  // namespace

void addLaunchCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("launch", "fly a mission on this computer and end when all agree");
  const auto flags = std::make_shared<LaunchFlags>();
  LaunchOptions& o = flags->launch;
  command->add_option("--world", o.world,
                      "reef:sparse, reef:varied, reef:tuning, a world folder, or a recording");
  command->add_option("--robots", o.num_robots,
                      "how many fly; 0 (the default): 12, or as many as were recorded");
  command
      ->add_option("--observations", o.observations,
                   "images per robot, 0 = as many as cover its share, or all that were recorded")
      ->capture_default_str();
  command->add_option("--seed", o.seed, "decides all randomness")->capture_default_str();
  command
      ->add_option("--budget", o.budget, "bytes per second of mission time for each process, 0 = unlimited")
      ->capture_default_str();
  command
      ->add_option("--link", o.link,
                   "what every process hears through: clean, mesh, acoustic, satellite or a file")
      ->capture_default_str();
  command->add_option("--key", o.key,
                      "file with the team's key, made by keygen: only who has it is listened to");
  command
      ->add_option("--library", o.library,
                   "names of missions before, from library save: what is known arrives named")
      ->check(CLI::ExistingFile);
  command->add_option("--rate", o.rate, "mission seconds per wall second: 1, 10, or max")
      ->capture_default_str();
  command
      ->add_option("--matcher", o.matcher.matcher, "id, hungarian, incremental, components, clear or shoal")
      ->capture_default_str();
  command->add_option("--similarity", flags->similarity,
                      "cosine, overlap, l1, l2, hellinger, js or discounted (default: the matcher's usual)");
  command
      ->add_option("--sigma", flags->sigma,
                   "least similarity of a match: auto (the matcher's usual) or a number in (0, 1]")
      ->capture_default_str();
  command->add_option("--profile", o.profile, "words and hyper-parameters: best or paper")
      ->capture_default_str();
  command
      ->add_option("--bootstrap", o.bootstrap,
                   "topics.json of a robot of an earlier mission: topics to begin with")
      ->check(CLI::ExistingFile);
  command
      ->add_option("--detail", o.detail,
                   "of topics and certainties on the link: fine, or coarse for fewer bytes")
      ->capture_default_str();
  command->add_flag("!--no-look-again", o.looks_again,
                    "robots do not look again at their maps, when all have landed, with what the team knows");
  command->add_option("--cell-size-m", o.cell_size_m, "edge of a cell, m (default: the world's)");
  command->add_option("--camera", o.camera, "camera.json with the intrinsics (default: the world's usual)");
  command->add_option(
      "--altitude-m", o.altitude_m,
      "camera height, m (default: native resolution); of a recording without depth, above a flat floor");
  command->add_option("--frame-period-s", o.frame_period_s, "mission seconds between images")
      ->capture_default_str();
  command->add_option("--exposure", o.sensors.exposure, "robots differ in brightness by up to 1 + this")
      ->capture_default_str();
  command->add_option("--color-cast", o.sensors.color_cast, "robots differ in each colour by up to this part")
      ->capture_default_str();
  command
      ->add_option("--pose-drift", o.sensors.pose_drift,
                   "dead reckoning's error, m per square root of a metre flown")
      ->capture_default_str();
  command->add_option("--depth-noise", o.sensors.depth_noise, "standard deviation of depth over depth")
      ->capture_default_str();
  command->add_option("--depth-holes", o.sensors.depth_holes, "part of the depth that is missing")
      ->capture_default_str();
  command->add_option("--out", o.out, "folder for the mission's files");
  command->add_flag("--overwrite", o.overwrite,
                    "replace a mission in --out, ended or interrupted, with all its files");
  command->add_flag("--single", o.single, "also fly one robot over the whole area, into single/");
  command->add_flag("--record", o.record, "record all messages with lcm-logger, into mission.lcmlog");
  command->add_option("--lcm-url", o.lcm_url, "multicast group (default: a free port of this host)")
      ->envname("SHOAL_LCM_URL");
  command->add_option("--mission", o.mission, "mission number (default: a new one)");
  command
      ->add_option("--settle-timeout-s", o.settle_timeout_s,
                   "wall seconds without any change after which a landed team is given up")
      ->capture_default_str();
  command->add_option("--kill-plan", o.kill_plan,
                      "robots that crash and begin anew: lines `t_s ROBOT kill|restart|anew`");
  command->footer(
      "  operator_console launch --world reef:varied --robots 12 --observations 60 --out runs/a\n"
      "  operator_console launch --world bay --link acoustic --budget 200 --record --out runs/b");
  command->callback([&app, &chosen, flags] {
    chosen = [&app, flags] {
      LaunchOptions options = flags->launch;
      options.matcher.sigma = matching::parseSigma(flags->sigma);
      options.matcher.similarity =
          flags->similarity.empty() ? matching::usualSimilarity(options.matcher.matcher) : flags->similarity;
      options.log_level = app.get_option("--log-level")->as<std::string>();
      return launch(std::move(options));
    };
  });
}

}  // namespace shoal::console
