// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/camera_file.h"

#include <string>

#include "world_on_disk.h"

namespace shoal::world {
namespace {

const nlohmann::json kGood = {{"width", 64},
                              {"height", 48},
                              {"fx", 50.5},
                              {"fy", 51},
                              {"cx", 31.5},
                              {"cy", 23.5},
                              {"note", "unknown keys are fine"}};

std::string complaintOf(const nlohmann::json& camera) {
  return complaint([&] { (void)parseCamera(camera.dump(), "camera.json"); });
}

TEST(CameraFileTest, ReadsIntrinsicsAndLeavesTheRestOpen) {
  const Camera camera = parseCamera(kGood.dump(), "camera.json");
  EXPECT_EQ(camera.intrinsics.width, 64);
  EXPECT_EQ(camera.intrinsics.height, 48);
  EXPECT_EQ(camera.intrinsics.fx, 50.5);
  EXPECT_EQ(camera.intrinsics.fy, 51);
  EXPECT_EQ(camera.intrinsics.cx, 31.5);
  EXPECT_EQ(camera.intrinsics.cy, 23.5);
  EXPECT_FALSE(camera.depth_factor.has_value());
  EXPECT_FALSE(camera.max_depth_m.has_value());
  EXPECT_TRUE(camera.classes.empty());
  EXPECT_EQ(camera.unlabelled, 255);
  EXPECT_TRUE(camera.body_from_camera.isApprox(Pose::Identity(), 0));
}

TEST(CameraFileTest, ReadsDepthClassesAndMounting) {
  nlohmann::json json = kGood;
  json["depth_factor"] = 5000;
  json["max_depth_m"] = 4.5;
  json["unlabelled"] = 7;
  json["classes"] = {{{"id", 2}, {"name", "sand"}, {"rgb", {1, 2, 3}}}};
  // A quarter turn about Z: the camera's x axis is the body's y axis.
  json["body_from_camera"] = {{"translation_m", {1, 2, 3}},
                              {"quaternion_wxyz", {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}}};
  const Camera camera = parseCamera(json.dump(), "camera.json");
  EXPECT_EQ(camera.depth_factor, 5000);
  EXPECT_EQ(camera.max_depth_m, 4.5);
  EXPECT_EQ(camera.unlabelled, 7);
  ASSERT_EQ(camera.classes.size(), 1u);
  EXPECT_EQ(camera.classes[0].name, "sand");
  EXPECT_TRUE((camera.body_from_camera * Eigen::Vector3d(1, 0, 0)).isApprox(Eigen::Vector3d(1, 3, 3), 1e-12));
}

TEST(CameraFileTest, NamesWhatIsWrong) {
  for (const char* key : {"width", "height", "fx", "fy", "cx", "cy"}) {
    nlohmann::json json = kGood;
    json.erase(key);
    EXPECT_NE(complaintOf(json).find(key), std::string::npos) << key;
    json[key] = "wide";
    EXPECT_NE(complaintOf(json).find(key), std::string::npos) << key;
  }
  const auto with = [](const char* key, const nlohmann::json& value) {
    nlohmann::json json = kGood;
    json[key] = value;
    return complaintOf(json);
  };
  EXPECT_NE(with("fx", 0).find("> 0"), std::string::npos);
  EXPECT_NE(with("depth_factor", -1).find("depth_factor"), std::string::npos);
  EXPECT_NE(with("max_depth_m", 0).find("max_depth_m"), std::string::npos);
  EXPECT_NE(with("classes", {{{"id", 300}}}).find("classes[0].id"), std::string::npos);
  EXPECT_NE(with("unlabelled", 256).find("unlabelled"), std::string::npos);
  EXPECT_NE(with("body_from_camera", 1).find("body_from_camera"), std::string::npos);
  EXPECT_NE(with("body_from_camera", {{"translation_m", {0, 0, 0}}, {"quaternion_wxyz", {0, 0, 0, 0}}})
                .find("quaternion_wxyz"),
            std::string::npos);
  EXPECT_NE(complaint([] { (void)parseCamera("[]", "camera.json"); }).find("object"), std::string::npos);
  EXPECT_NE(complaint([] { (void)parseCamera("{", "camera.json"); }).find("broken JSON"), std::string::npos);
  EXPECT_NE(complaint([] { (void)parseCamera(R"({"fx": 1e999})", "camera.json"); }).find("broken JSON"),
            std::string::npos);
  EXPECT_NE(complaint([] { (void)readCamera("no/such/camera.json"); }).find("not found"), std::string::npos);
}

TEST(CameraFileTest, WhatIsGivenBesideSaysIntrinsicsAndKeepsTheRest) {
  Camera own = parseCamera(kGood.dump(), "camera.json");
  own.depth_factor = 100;
  own.classes = {{1, "rock", {}}};
  own.unlabelled = 0;
  Camera given;
  given.intrinsics.fx = 77;
  EXPECT_EQ(overridden(own, given).intrinsics.fx, 77);
  EXPECT_EQ(overridden(own, given).depth_factor, 100);
  EXPECT_EQ(overridden(own, given).unlabelled, 0);
  given.depth_factor = 1000;
  EXPECT_EQ(overridden(own, given).depth_factor, 1000);
}

}  // namespace
}  // namespace shoal::world
