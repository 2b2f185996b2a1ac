// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <vector>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "operator_console/bag/import_bag.h"
#include "operator_console/command.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct Flags {
  ImportOptions options;
  std::vector<double> camera_on_body;
  bool json = false;
};

int import(const Flags& flags) {
  ImportOptions options = flags.options;
  std::ranges::copy(flags.camera_on_body, options.body_from_camera.begin());
  const Imported done = importBag(options);
  if (done.distorted) {
    spdlog::warn("{} has lens distortion, and pictures are taken as they are: undistort first (image_proc)",
                 done.info);
  }
  for (const auto& [why, count] : done.left_out) spdlog::warn("{} messages left out: {}", count, why);
  if (flags.json) {
    const auto topic = [](const std::string& name) { return name.empty() ? Json() : Json(name); };
    std::cout << Json{{"folder", options.folder},   {"image", topic(done.image)},
                      {"depth", topic(done.depth)}, {"pose", topic(done.pose)},
                      {"info", topic(done.info)},   {"images", done.images},
                      {"depths", done.depths},      {"poses", done.poses},
                      {"left_out", done.left_out},  {"distorted", done.distorted}}
                     .dump(2)
              << '\n';
    return 0;
  }
  fmt::print("{}: {} pictures of {}, {} depth pictures{}, {} poses of {}\n", options.folder, done.images,
             done.image, done.depths, done.depth.empty() ? "" : " of " + done.depth, done.poses, done.pose);
  return 0;
}

}  // namespace

void addImportCommand(CLI::App& app, Action& chosen) {
  CLI::App* command =
      app.add_subcommand("import", "makes a ROS 2 bag a recording that robots can fly, without ROS");
  const auto flags = std::make_shared<Flags>();
  ImportOptions& o = flags->options;
  command->add_option("bag", o.bag, "a .db3 or .mcap file, or the folder of a bag")->required();
  command->add_option("--out", o.folder, "folder to make: one robot's recording in TUM layout")->required();
  command->add_option("--image", o.image,
                      "topic with colour: Image or CompressedImage (default: the only one)");
  command->add_option("--depth", o.depth, "topic with depth (default: the only one that says depth, if any)");
  command->add_option(
      "--pose", o.pose,
      "topic with Odometry, PoseStamped or PoseWithCovarianceStamped (default: the only one)");
  command->add_option("--info", o.info,
                      "topic with CameraInfo (default: the only one that does not say depth)");
  command->add_option("--camera", o.camera, "a camera.json in place of CameraInfo")->check(CLI::ExistingFile);
  command
      ->add_option(
          "--camera-on-body", flags->camera_on_body,
          "where the camera's optical frame is on the body that the poses are of: tx ty tz qx qy qz qw\n"
          "(default: the poses are the camera's)")
      ->expected(7);
  command->add_flag("--json", flags->json, "answer in JSON");
  command->footer(
      "tf is not read: poses are those of one topic, in one world frame. What cannot be read is left out and "
      "said.\n"
      "For a team, import each robot's bag into FOLDER/robot0, FOLDER/robot1, ...\n\n"
      "  operator_console import dive.mcap --out dive/robot0 --pose /odometry/filtered \\\n"
      "      --camera-on-body 0.1 0 -0.2 0.7071 -0.7071 0 0\n"
      "  operator_console launch --world dive --out runs/dive");
  command->callback([flags, &chosen] { chosen = [flags] { return import(*flags); }; });
}

}  // namespace shoal::console
