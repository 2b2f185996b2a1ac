// SPDX-License-Identifier: BSD-3-Clause
#include <string>
#include <vector>

#include "shoal/world/world.h"
#include "world_on_disk.h"

namespace shoal::world {
namespace {

void expectRefusal(const std::string& spec, const std::vector<std::string>& parts) {
  const std::string said = complaint([&] { (void)openWorld(spec); });
  for (const std::string& part : parts) EXPECT_NE(said.find(part), std::string::npos) << spec << ": " << said;
}

TEST(OpenWorldTest, OpensFolders) {
  const WorldOnDisk disk;
  disk.writeGoodWorld();
  EXPECT_EQ(openWorld(disk.folder().string())->name(), "tiny");
  EXPECT_EQ(openWorld(disk.folder().string() + "/")->name(), "tiny");
}

TEST(OpenWorldTest, OpensEachReef) {
  for (const char* reef : {"reef:sparse", "reef:varied", "reef:tuning"}) {
    EXPECT_EQ(openWorld(reef, 3)->name(), reef);
  }
}

TEST(OpenWorldTest, ListsTheReefsThatThereAre) {
  for (const char* spec : {"reef:", "reef:dense", "reef:Sparse"}) {
    expectRefusal(spec, {spec, "reef:sparse", "reef:varied", "reef:tuning"});
  }
}

TEST(OpenWorldTest, SaysWhatAWorldIs) {
  const WorldOnDisk disk;
  const std::string folder = disk.folder().string();
  expectRefusal("", {"world.json", "reef:sparse"});
  expectRefusal(folder + "/nowhere", {folder + "/nowhere", "world.json", "reef:sparse"});
  expectRefusal(folder, {folder + "/world.json", "not found"});
  disk.write("file", "");
  expectRefusal(folder + "/file", {folder + "/file", "is a file", "world.json"});
}

TEST(OpenWorldTest, ALiveCameraIsForOneRobotsAgent) {
  expectRefusal("lcm:CAMERA", {"robot_agent --source lcm:CAMERA", "each robot"});
}

}  // namespace
}  // namespace shoal::world
