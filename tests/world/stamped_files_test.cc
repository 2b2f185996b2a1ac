// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/stamped_files.h"

#include "world_on_disk.h"

namespace shoal::world {
namespace {

TEST(StampedFilesTest, ReadsAListHoweverItWasWritten) {
  const WorldOnDisk disk;
  disk.write("rgb.txt",
             "\xef\xbb\xbf# timestamp filename\r\n"
             "2.5 rgb/b.png\r\n"
             "\r\n"
             "1305031102.175304\trgb/with a blank.png  \n"
             "  1.000001,rgb/a.png\n"
             "2.5 rgb/again.png\n"
             "soon rgb/c.png\n"
             "nan rgb/d.png\n"
             "1e300 rgb/e.png\n"
             "3\n");
  const auto list = readPictureList(disk.folder(), "rgb");
  ASSERT_TRUE(list);
  ASSERT_EQ(list->entries.size(), 3u);
  EXPECT_EQ(list->entries[0].time.us, 1'000'001);
  EXPECT_EQ(list->entries[0].file, disk.folder() / "rgb/a.png");
  EXPECT_EQ(list->entries[1].time.us, 2'500'000);
  EXPECT_EQ(list->entries[1].file, disk.folder() / "rgb/b.png");
  EXPECT_EQ(list->entries[2].time.us, 1'305'031'102'175'304);
  EXPECT_EQ(list->entries[2].file, disk.folder() / "rgb/with a blank.png");
  EXPECT_EQ(list->bad_lines, 4);
  EXPECT_EQ(list->duplicates, 1);
}

TEST(StampedFilesTest, WithoutAListTheNamesAreTheTimes) {
  const WorldOnDisk disk;
  EXPECT_FALSE(readPictureList(disk.folder(), "rgb"));
  std::filesystem::create_directories(disk.folder() / "rgb");
  for (const char* name : {"rgb/10.5.png", "rgb/9.jpg", "rgb/first.png", "rgb/7.txt"}) disk.write(name, "");
  const auto list = readPictureList(disk.folder(), "rgb");
  ASSERT_TRUE(list);
  ASSERT_EQ(list->entries.size(), 2u);
  EXPECT_EQ(list->entries[0].time.us, 9'000'000);
  EXPECT_EQ(list->entries[1].time.us, 10'500'000);
  EXPECT_EQ(list->bad_lines, 1);
}

TEST(StampedFilesTest, ReadsPosesAndLeavesOutWhatIsNone) {
  const WorldOnDisk disk;
  disk.write("groundtruth.txt",
             "# timestamp tx ty tz qx qy qz qw\r\n"
             "2 1 2 3 0 0 0 1\r\n"
             "1 4 5 6 0.6 0 0 0.8\n"
             "3 1 2 3 0 0 0\n"
             "4 1 2 nan 0 0 0 1\n"
             "5 1 2 3 0 0 0 0\n"
             "2 9 9 9 0 0 0 1\n");
  const auto list = readPoseList(disk.folder() / "groundtruth.txt");
  ASSERT_EQ(list.entries.size(), 2u);
  EXPECT_EQ(list.entries[0].time.us, 1'000'000);
  EXPECT_EQ(list.entries[0].orientation.x(), 0.6);
  EXPECT_EQ(list.entries[0].orientation.w(), 0.8);
  EXPECT_EQ(list.entries[1].position, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(list.bad_lines, 3);
  EXPECT_EQ(list.duplicates, 1);
  EXPECT_THROW(readPoseList(disk.folder() / "none.txt"), std::invalid_argument);
}

}  // namespace
}  // namespace shoal::world
