// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/world_folder.h"

#include <string>
#include <vector>

#include "world_on_disk.h"

namespace shoal::world {
namespace {

using nlohmann::json;

TEST(WorldFolderTest, IsReadAsWritten) {
  const WorldOnDisk disk;
  disk.writeGoodWorld();
  const auto world = readWorldFolder(disk.folder());
  EXPECT_EQ(world->name(), "tiny");
  EXPECT_DOUBLE_EQ(world->metresPerPixel(), 0.5);
  EXPECT_DOUBLE_EQ(world->extent().max_x, 2.75);
  EXPECT_DOUBLE_EQ(world->extent().min_y, -1.75);
  ASSERT_EQ(world->classes().size(), 2u);
  EXPECT_EQ(world->classes()[1].id, 3);
  EXPECT_EQ(world->classes()[1].name, "rock");
  EXPECT_EQ(world->classes()[1].rgb, (std::array<uint8_t, 3>{4, 5, 6}));

  const Observation seen = world->render({1, 1, 10, 10, 0, 0}, lookingDown({1.0, -0.5, 5.0}));
  EXPECT_EQ(seen.color.at<cv::Vec3b>(0, 0), cv::Vec3b(1, 2, 3));  // the pixel at (2, 1)
  EXPECT_EQ(seen.labels.at<uint8_t>(0, 0), 0);
}

TEST(WorldFolderTest, NeedsNeitherNameNorLabels) {
  const WorldOnDisk disk;
  json world = disk.writeGoodWorld();
  for (const char* key : {"name", "labels", "classes", "unlabelled"}) world.erase(key);
  disk.write("world.json", world.dump());
  std::filesystem::remove(disk.folder() / "labels.png");
  const auto read = readWorldFolder(disk.folder() / "");  // a slash at the end changes nothing
  EXPECT_EQ(read->name(), disk.folder().filename());
  EXPECT_FALSE(read->hasFlatTruth());
}

struct Mistake {
  const char* key;                // of world.json
  json value;                     // null: the key is left out
  std::vector<const char*> said;  // what the message must hold
};

TEST(WorldFolderTest, NamesTheFileAndTheKeyThatIsWrong) {
  const WorldOnDisk disk;
  const json good = disk.writeGoodWorld();
  const json sand = {{"id", 0}, {"name", "sand"}, {"rgb", {1, 2, 3}}};
  const auto classWith = [&](const char* key, const json& value) {
    json changed = sand;
    changed[key] = value;
    return json::array({changed});
  };
  const std::vector<Mistake> mistakes{
      {"metres_per_pixel", nullptr, {"metres_per_pixel", "> 0"}},
      {"metres_per_pixel", 0, {"metres_per_pixel", "> 0"}},
      {"metres_per_pixel", -1.5, {"metres_per_pixel", "-1.5"}},
      {"metres_per_pixel", "1", {"metres_per_pixel", "number"}},
      {"size_px", nullptr, {"size_px", "[width, height]"}},
      {"size_px", {6}, {"size_px"}},
      {"size_px", {6, 0}, {"size_px[1]", "got 0"}},
      {"size_px", {6.5, 4}, {"size_px[0]", "integer"}},
      {"size_px", {6, 5}, {"world.json says 6 x 5", "6 x 4"}},
      {"image", nullptr, {"image", "file name"}},
      {"image", 3, {"image", "file name"}},
      {"image", "nowhere.jpg", {"nowhere.jpg", "not found"}},
      {"labels", nullptr, {"labels", "file name"}},
      {"labels", "nowhere.png", {"nowhere.png", "not found"}},
      {"labels", "world.png", {"world.png", "one channel"}},
      {"unlabelled", 0, {"unlabelled", "255"}},
      {"name", 7, {"name"}},
      {"classes", nullptr, {"classes", "id, name, rgb"}},
      {"classes", json::array(), {"classes"}},
      {"classes", {1}, {"classes[0]", "object"}},
      {"classes", json::array({sand, sand}), {"classes[1].id", "distinct"}},
      {"classes", classWith("id", 255), {"classes[0].id", "[0, 254]", "255"}},
      {"classes", classWith("id", "zero"), {"classes[0].id", "integer"}},
      {"classes", classWith("name", ""), {"name", "classes[0]"}},
      {"classes", classWith("rgb", {1, 2}), {"classes[0].rgb"}},
      {"classes", classWith("rgb", {1, 2, 256}), {"classes[0].rgb[2]", "256"}},
      {"classes", json::array({sand}), {"labels.png", "label 3", "(1, 0)", "255"}},
  };
  for (const Mistake& mistake : mistakes) {
    json world = good;
    if (mistake.value.is_null()) {
      world.erase(mistake.key);
    } else {
      world[mistake.key] = mistake.value;
    }
    disk.write("world.json", world.dump());
    const std::string said = complaint([&] { (void)readWorldFolder(disk.folder()); });
    EXPECT_NE(said.find(disk.folder().string()), std::string::npos) << mistake.key << ": " << said;
    for (const char* part : mistake.said) {
      EXPECT_NE(said.find(part), std::string::npos) << mistake.key << " should say " << part << ": " << said;
    }
  }
}

TEST(WorldFolderTest, SaysWhereTheJsonIsBroken) {
  const WorldOnDisk disk;
  disk.write("world.json", "{\n\"name\": \"x\",\n oops }");
  const std::string said = complaint([&] { (void)readWorldFolder(disk.folder()); });
  EXPECT_NE(said.find("world.json"), std::string::npos) << said;
  EXPECT_NE(said.find("line 3"), std::string::npos) << said;
  disk.write("world.json", "[1, 2]");
  EXPECT_NE(complaint([&] { (void)readWorldFolder(disk.folder()); }).find("object"), std::string::npos);
  disk.write("world.json", "");
  EXPECT_NE(complaint([&] { (void)readWorldFolder(disk.folder()); }).find("broken JSON"), std::string::npos);
}

TEST(WorldFolderTest, RefusesLabelsOfAnotherSizeAndPicturesThatAreNone) {
  const WorldOnDisk disk;
  disk.writeGoodWorld();
  disk.write("labels.png", cv::Mat(6, 4, CV_8UC1, cv::Scalar(0)));
  std::string said = complaint([&] { (void)readWorldFolder(disk.folder()); });
  EXPECT_NE(said.find("labels.png"), std::string::npos) << said;
  EXPECT_NE(said.find("4 x 6"), std::string::npos) << said;
  disk.write("labels.png", "not a picture");
  said = complaint([&] { (void)readWorldFolder(disk.folder()); });
  EXPECT_NE(said.find("labels.png"), std::string::npos) << said;
  EXPECT_NE(said.find("decoded"), std::string::npos) << said;
  disk.write("labels.png", cv::Mat(4, 6, CV_16UC1, cv::Scalar(0)));
  said = complaint([&] { (void)readWorldFolder(disk.folder()); });
  EXPECT_NE(said.find("8 bits"), std::string::npos) << said;
}

}  // namespace
}  // namespace shoal::world
