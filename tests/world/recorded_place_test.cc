// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/recorded_place.h"

#include <string>

#include "world_on_disk.h"

namespace shoal::world {
namespace {

namespace fs = std::filesystem;

constexpr int kPictureWidth = 16, kPictureHeight = 12;

// A recording of pictures one second apart from second 100: picture i has blue = i, depth 2 m + i cm, and
// label i % 2; the camera is at x = i.
class Recorded {
 public:
  explicit Recorded(const WorldOnDisk& disk, std::string folder = "", int frames = 4)
      : disk_(disk), folder_(std::move(folder)), frames_(frames) {
    for (const char* kind : {"rgb", "depth", "labels"}) fs::create_directories(path() / kind);
    camera = {{"width", kPictureWidth},
              {"height", kPictureHeight},
              {"fx", 20},
              {"fy", 20},
              {"cx", 7.5},
              {"cy", 5.5},
              {"depth_factor", 100}};
    camera["classes"] = {{{"id", 0}, {"name", "sand"}, {"rgb", {1, 2, 3}}},
                         {{"id", 1}, {"name", "rock"}, {"rgb", {4, 5, 6}}}};
    writeCamera();
    std::string poses, rgb = "# timestamp filename\n";
    for (int i = 0; i < frames_; ++i) {
      const std::string name = stamp(i) + ".png";
      picture("rgb/" + name, cv::Mat(kPictureHeight, kPictureWidth, CV_8UC3, cv::Scalar(i, 50, 60)));
      picture("depth/" + name, cv::Mat(kPictureHeight, kPictureWidth, CV_16UC1, cv::Scalar(200 + i)));
      picture("labels/" + name, cv::Mat(kPictureHeight, kPictureWidth, CV_8UC1, cv::Scalar(i % 2)));
      poses += stamp(i) + " " + std::to_string(i) + " 0 10 1 0 0 0\n";
      rgb += stamp(i) + " rgb/" + name + "\n";
    }
    text("groundtruth.txt", poses);
    text("rgb.txt", rgb);
  }

  static std::string stamp(int i) { return std::to_string(100 + i) + ".0"; }
  fs::path path() const { return folder_.empty() ? disk_.folder() : disk_.folder() / folder_; }
  void text(const std::string& file, const std::string& content) const { disk_.write(in(file), content); }
  void picture(const std::string& file, const cv::Mat& pixels) const { disk_.write(in(file), pixels); }
  void writeCamera() const { text("camera.json", camera.dump()); }

  nlohmann::json camera;

 private:
  std::string in(const std::string& file) const { return folder_.empty() ? file : folder_ + "/" + file; }
  const WorldOnDisk& disk_;
  std::string folder_;
  int frames_;
};

struct FlownPlace {
  std::vector<Observation> frames;
  std::string troubles;
};

FlownPlace fly(const Place& place, const SurveyOptions& options = {}, int robot = 0, bool single = false) {
  const auto source = place.source(options, robot, single);
  FlownPlace flight;
  while (auto frame = source->next()) flight.frames.push_back(std::move(*frame));
  flight.troubles = source->troubles();
  return flight;
}

std::string complaintOf(const fs::path& folder, const SurveyOptions& options = {}) {
  return complaint([&] { (void)openPlace(folder.string())->completed(options); });
}

TEST(RecordedPlaceTest, FliesEveryFrameFromTimeZero) {
  const WorldOnDisk disk;
  const Recorded recorded(disk);
  const auto place = openPlace(disk.folder().string());
  EXPECT_TRUE(place->isRecorded());
  EXPECT_EQ(place->maxRobots(), 1);
  EXPECT_EQ(place->name(), disk.folder().filename());
  ASSERT_EQ(place->classes().size(), 2u);
  EXPECT_FALSE(place->extent());
  EXPECT_FALSE(place->hasFlatTruth());
  const FlownPlace flight = fly(*place);
  ASSERT_EQ(flight.frames.size(), 4u);
  EXPECT_EQ(flight.troubles, "");
  for (int i = 0; i < 4; ++i) {
    const Observation& frame = flight.frames[static_cast<size_t>(i)];
    EXPECT_EQ(frame.number, i);
    EXPECT_EQ(frame.time.us, i * 1'000'000);
    EXPECT_EQ(frame.color.at<cv::Vec3b>(3, 4), cv::Vec3b(static_cast<uint8_t>(i), 50, 60));
    EXPECT_FLOAT_EQ(frame.depth_m.at<float>(3, 4), 2.0f + 0.01f * static_cast<float>(i));
    EXPECT_EQ(frame.labels.at<uint8_t>(3, 4), i % 2);
    EXPECT_TRUE(frame.world_from_camera.translation().isApprox(Eigen::Vector3d(i, 0, 10), 1e-12));
    EXPECT_TRUE(frame.world_from_camera.linear().isApprox(lookingDown({0, 0, 0}).linear(), 1e-12));
    EXPECT_EQ(frame.intrinsics.fx, 20);
  }
}

TEST(RecordedPlaceTest, FewerObservationsAreSpreadOverTheRecording) {
  const WorldOnDisk disk;
  const Recorded recorded(disk, "", 9);
  SurveyOptions options;
  options.observations = 3;
  const FlownPlace flight = fly(*openPlace(disk.folder().string()), options);
  ASSERT_EQ(flight.frames.size(), 3u);
  EXPECT_EQ(flight.frames[1].time.us, 3'000'000);
  EXPECT_EQ(flight.frames[2].time.us, 6'000'000);
  EXPECT_EQ(flight.frames[2].number, 2);
  options.observations = 100;
  EXPECT_EQ(openPlace(disk.folder().string())->completed(options).observations, 9);
}

// 24 pixels at 2.015 m (the median of 2.00 to 2.03) with fx 20 are 2.4 m.
TEST(RecordedPlaceTest, CellsAre24PixelsAtTheMedianDepth) {
  const WorldOnDisk disk;
  const Recorded recorded(disk);
  EXPECT_DOUBLE_EQ(openPlace(disk.folder().string())->completed({}).cell_size_m, 2.4);
  SurveyOptions options;
  options.cell_size_m = 0.7;
  EXPECT_EQ(openPlace(disk.folder().string())->completed(options).cell_size_m, 0.7);
}

TEST(RecordedPlaceTest, ATeamIsFoldersByNumber) {
  const WorldOnDisk disk;
  const Recorded first(disk, "robot0", 2), second(disk, "robot1", 3);
  disk.write("notes.txt", "");
  const auto place = openPlace(disk.folder().string());
  EXPECT_EQ(place->maxRobots(), 2);
  SurveyOptions options;
  options.num_robots = 2;
  EXPECT_EQ(fly(*place, options, 0).frames.size(), 2u);
  EXPECT_EQ(fly(*place, options, 1).frames.size(), 3u);
  EXPECT_THROW((void)place->source(options, 2), std::invalid_argument);
  const FlownPlace single = fly(*place, options, 0, true);
  ASSERT_EQ(single.frames.size(), 5u);
  for (size_t i = 0; i < 5; ++i) EXPECT_EQ(single.frames[i].time.us, static_cast<int64_t>(i) * 1'000'000);
  options.num_robots = 3;
  const std::string said = complaint([&] { (void)place->completed(options); });
  EXPECT_NE(said.find("recording of 2 robots"), std::string::npos) << said;
}

TEST(RecordedPlaceTest, ATeamHasNoGapsAndOneLegend) {
  const WorldOnDisk disk;
  Recorded second(disk, "robot1");
  EXPECT_NE(complaintOf(disk.folder()).find("robot0 is missing"), std::string::npos);
  const Recorded first(disk, "robot0");
  second.camera["classes"][0]["name"] = "gravel";
  second.writeCamera();
  EXPECT_NE(complaintOf(disk.folder()).find("classes"), std::string::npos);
}

TEST(RecordedPlaceTest, PicturesPairWithWhatIsNearInTime) {
  const WorldOnDisk disk;
  const Recorded recorded(disk);
  recorded.text("depth.txt",
                "100.021 depth/100.0.png\n"  // too far from 100
                "100.98 depth/101.0.png\n"   // .02 s from 101
                "102.01 depth/103.0.png\n"   // .01 s from 102: nearer than the next
                "101.985 depth/102.0.png\n"
                "103 depth/none.png\n");
  const FlownPlace flight = fly(*openPlace(disk.folder().string()));
  ASSERT_EQ(flight.frames.size(), 2u);
  EXPECT_FLOAT_EQ(flight.frames[0].depth_m.at<float>(0, 0), 2.01f);
  EXPECT_EQ(flight.frames[0].time.us, 0);  // the first that flies
  EXPECT_FLOAT_EQ(flight.frames[1].depth_m.at<float>(0, 0), 2.03f);
  EXPECT_EQ(flight.troubles, "1 pictures without depth, 1 x depth picture missing or unreadable");
}

TEST(RecordedPlaceTest, PosesAreInterpolatedAndMissingOnesCounted) {
  const WorldOnDisk disk;
  const Recorded recorded(disk);
  recorded.text("groundtruth.txt",
                "101.1 5 0 10 1 0 0 0\n"
                "100.9 3 0 10 1 0 0 0\n"
                "103.015 8 0 10 1 0 0 0\n"
                "broken\n");
  const FlownPlace flight = fly(*openPlace(disk.folder().string()));
  ASSERT_EQ(flight.frames.size(), 2u);
  EXPECT_NEAR(flight.frames[0].world_from_camera.translation().x(), 4.0, 1e-9);
  EXPECT_NEAR(flight.frames[1].world_from_camera.translation().x(), 8.0, 1e-9);
  EXPECT_EQ(flight.troubles, "1 unreadable entries of groundtruth.txt, 2 pictures without a pose");
}

TEST(RecordedPlaceTest, BadPicturesAreSkippedAndCounted) {
  const WorldOnDisk disk;
  const Recorded recorded(disk, "", 7);
  recorded.text("rgb/101.0.png", "no picture");
  recorded.picture("rgb/102.0.png", cv::Mat(kPictureHeight, kPictureWidth + 1, CV_8UC3, cv::Scalar::all(1)));
  recorded.picture("depth/103.0.png", cv::Mat(kPictureHeight, kPictureWidth, CV_8UC1, cv::Scalar(1)));
  recorded.picture("depth/104.0.png",
                   cv::Mat(kPictureHeight / 2, kPictureWidth / 2, CV_16UC1, cv::Scalar(1)));
  recorded.picture("labels/105.0.png", cv::Mat(kPictureHeight, kPictureWidth, CV_8UC3, cv::Scalar::all(1)));
  const FlownPlace flight = fly(*openPlace(disk.folder().string()));
  ASSERT_EQ(flight.frames.size(), 3u);
  EXPECT_EQ(flight.frames[1].number, 1);
  EXPECT_EQ(flight.frames[1].time.us, 5'000'000);
  EXPECT_TRUE(flight.frames[1].labels.empty());
  EXPECT_EQ(
      flight.troubles,
      "1 x colour picture missing or unreadable, 1 x colour picture of another size, 1 x depth picture not "
      "of 16 bits, 1 x depth picture of another size, 1 x label picture unreadable (flown without)");
}

TEST(RecordedPlaceTest, NoDepthIsZeroAndWhatIsTooFarIsNone) {
  const WorldOnDisk disk;
  Recorded recorded(disk, "", 1);
  recorded.camera["max_depth_m"] = 5;
  recorded.writeCamera();
  cv::Mat_<uint16_t> raw(kPictureHeight, kPictureWidth, uint16_t{300});
  raw(0, 0) = 0;
  raw(0, 1) = 65535;
  raw(0, 2) = 500;
  raw(0, 3) = 501;
  recorded.picture("depth/100.0.png", raw);
  const FlownPlace flight = fly(*openPlace(disk.folder().string()));
  const cv::Mat& depth = flight.frames.at(0).depth_m;
  EXPECT_EQ(depth.at<float>(0, 0), 0.0f);
  EXPECT_EQ(depth.at<float>(0, 1), 0.0f);
  EXPECT_EQ(depth.at<float>(0, 2), 5.0f);
  EXPECT_EQ(depth.at<float>(0, 3), 0.0f);
  EXPECT_EQ(depth.at<float>(0, 4), 3.0f);
}

TEST(RecordedPlaceTest, LabelsThatAreNoClassAreUnlabelled) {
  const WorldOnDisk disk;
  Recorded recorded(disk, "", 1);
  recorded.camera["unlabelled"] = 0;
  recorded.writeCamera();
  recorded.picture("labels/100.0.png", cv::Mat_<uint8_t>(kPictureHeight, kPictureWidth, uint8_t{1}));
  EXPECT_EQ(fly(*openPlace(disk.folder().string())).frames.at(0).labels.at<uint8_t>(0, 0), 1);
  recorded.picture("labels/100.0.png", cv::Mat_<uint8_t>(kPictureHeight, kPictureWidth, uint8_t{0}));
  EXPECT_EQ(fly(*openPlace(disk.folder().string())).frames.at(0).labels.at<uint8_t>(0, 0), 255);
  recorded.picture("labels/100.0.png", cv::Mat_<uint8_t>(kPictureHeight, kPictureWidth, uint8_t{9}));
  EXPECT_EQ(fly(*openPlace(disk.folder().string())).frames.at(0).labels.at<uint8_t>(0, 0), 255);
}

TEST(RecordedPlaceTest, WithoutDepthTheFloorIsFlatAtTheAltitude) {
  const WorldOnDisk disk;
  const Recorded recorded(disk);
  fs::remove_all(disk.folder() / "depth");
  EXPECT_NE(complaintOf(disk.folder()).find("--altitude-m"), std::string::npos);
  SurveyOptions options;
  options.altitude_m = 4;
  const auto place = openPlace(disk.folder().string());
  EXPECT_DOUBLE_EQ(place->completed(options).cell_size_m, 4.8);  // 24 px x 4 m / 20 px
  const FlownPlace flight = fly(*place, options);
  ASSERT_EQ(flight.frames.size(), 4u);
  EXPECT_FLOAT_EQ(flight.frames[0].depth_m.at<float>(0, 0), 4.0f);
}

TEST(RecordedPlaceTest, AGivenCameraSaysInstead) {
  const WorldOnDisk disk;
  const Recorded recorded(disk);
  Camera given;
  given.intrinsics = {kPictureWidth, kPictureHeight, 40, 40, 7.5, 5.5};
  const auto place = openPlace(disk.folder().string(), 1, given);
  const FlownPlace flight = fly(*place);
  EXPECT_EQ(flight.frames.at(0).intrinsics.fx, 40);
  EXPECT_FLOAT_EQ(flight.frames.at(0).depth_m.at<float>(0, 0), 2.0f);  // the folder's depth_factor
  fs::remove(disk.folder() / "camera.json");
  fs::remove_all(disk.folder() / "labels");
  given.depth_factor = 50;
  EXPECT_FLOAT_EQ(fly(*openPlace(disk.folder().string(), 1, given)).frames.at(0).depth_m.at<float>(0, 0),
                  4.0f);
}

TEST(RecordedPlaceTest, ClassesWithoutLabelsAreNoTruth) {
  const WorldOnDisk disk;
  const Recorded recorded(disk);
  fs::remove_all(disk.folder() / "labels");
  EXPECT_TRUE(openPlace(disk.folder().string())->classes().empty());
}

TEST(RecordedPlaceTest, SaysWhatIsMissingOrWrong) {
  const WorldOnDisk disk;
  Recorded recorded(disk);
  const nlohmann::json good = recorded.camera;
  const auto with = [&](const char* key, const nlohmann::json& value) {
    recorded.camera = good;
    recorded.camera[key] = value;
    recorded.writeCamera();
    return complaintOf(disk.folder());
  };
  EXPECT_NE(with("width", 32).find("is 16 x 12 pixels, but the camera is 32 x 12"), std::string::npos);
  EXPECT_NE(with("depth_factor", nullptr).find("depth_factor"), std::string::npos);
  EXPECT_NE(with("classes", nullptr).find("classes"), std::string::npos);
  recorded.camera = good;
  recorded.writeCamera();
  EXPECT_EQ(complaintOf(disk.folder()), "");

  recorded.picture("depth/100.0.png",
                   cv::Mat(kPictureHeight * 2, kPictureWidth * 2, CV_16UC1, cv::Scalar(1)));
  EXPECT_NE(complaintOf(disk.folder()).find("depth/100.0.png: is 32 x 24 pixels"), std::string::npos);
  recorded.picture("depth/100.0.png", cv::Mat(kPictureHeight, kPictureWidth, CV_16UC1, cv::Scalar(1)));
  fs::remove(disk.folder() / "camera.json");
  EXPECT_NE(complaintOf(disk.folder()).find("camera.json: not found"), std::string::npos);
  recorded.writeCamera();
  fs::remove(disk.folder() / "groundtruth.txt");
  EXPECT_NE(complaintOf(disk.folder()).find("groundtruth.txt: not found"), std::string::npos);
  recorded.text("groundtruth.txt", "7 0 0 0 0 0 0 1\n");
  EXPECT_NE(complaintOf(disk.folder()).find("none of its 4 pictures has a pose"), std::string::npos);
  fs::remove(disk.folder() / "rgb.txt");
  fs::remove_all(disk.folder() / "rgb");
  EXPECT_NE(complaintOf(disk.folder()).find("rgb"), std::string::npos);
}

}  // namespace
}  // namespace shoal::world
