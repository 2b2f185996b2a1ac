// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>

#include <spdlog/spdlog.h>

#include "fusion_node/process.h"
#include "operator_console/command.h"
#include "operator_console/play.h"
#include "operator_console/stop_signal.h"
#include "shoal/comms/camera_channels.h"
#include "shoal/comms/lcm_bus.h"
#include "shoal/comms/lcm_url.h"
#include "shoal/wire/camera_codec.h"

namespace shoal::console {
namespace {

struct PlayFlags {
  std::string folder, prefix = "CAM", rate = "1", lcm_url = comms::kDefaultUrl;
};

int playFolder(const PlayFlags& flags) {
  comms::LcmBusOptions options;
  options.channels = comms::CameraChannels(flags.prefix).all();
  options.max_message_bytes = wire::kMaxCameraBytes;
  const double rate = fusion_node::parseRate(flags.rate);
  comms::LcmBus bus(flags.lcm_url, options);
  catchStopSignals();
  if (!std::filesystem::is_directory(flags.folder)) throw std::runtime_error(flags.folder + " is no folder");
  spdlog::info("plays {} as {}_IMAGE, _DEPTH and _POSE on {}", flags.folder, flags.prefix, bus.url());
  const Played played = play(flags.folder, flags.prefix, rate, bus);
  spdlog::info("said {} images, {} depth images and {} poses", played.images, played.depths, played.poses);
  if (played.unreadable > 0) spdlog::warn("{} pictures could not be read", played.unreadable);
  return stopSignal() == 0 ? 0 : 128 + stopSignal();
}

}  // namespace

void addPlayCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand(
      "play", "say on LCM what a real robot's cameras would, for robot_agent --source lcm:PREFIX");
  const auto flags = std::make_shared<PlayFlags>();
  command->add_option("folder", flags->folder, "one robot's RGB-D folder in TUM layout")->required();
  command->add_option("--prefix", flags->prefix, "of the channels")->capture_default_str();
  command->add_option("--rate", flags->rate, "recorded seconds per wall second: 1, 10, or max")
      ->capture_default_str();
  command->add_option("--lcm-url", flags->lcm_url, "multicast group")
      ->envname("SHOAL_LCM_URL")
      ->capture_default_str();
  command->footer(
      "  operator_console play dives/robot0 --prefix CAM --rate 10\n"
      "  robot_agent --robot R00 --robots 1 --source lcm:CAM --out out");
  command->callback([flags, &chosen] { chosen = [flags] { return playFolder(*flags); }; });
}

}  // namespace shoal::console
