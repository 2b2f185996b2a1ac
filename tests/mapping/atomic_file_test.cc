// SPDX-License-Identifier: BSD-3-Clause
// A file is whole or not there, also on a disk that fails: fsync() and close() below stand in for the
// system's.
#include "shoal/mapping/atomic_file.h"

#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <filesystem>
#include <fstream>
#include <functional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace {

std::vector<std::string> flushed;  // "file", "folder"
bool file_fails = false, folder_fails = false, close_fails = false;

bool isFolder(int opened) {
  struct stat status {};
  return ::fstat(opened, &status) == 0 && S_ISDIR(status.st_mode);
}

int failWith(int reason) {
  errno = reason;
  return -1;
}

}  // namespace

extern "C" int fsync(int opened) {
  flushed.emplace_back(isFolder(opened) ? "folder" : "file");
  if (isFolder(opened) ? folder_fails : file_fails) return failWith(EIO);
  return static_cast<int>(::syscall(SYS_fsync, opened));
}

extern "C" int close(int opened) {
  const bool fails = close_fails && !isFolder(opened);
  const auto result = static_cast<int>(::syscall(SYS_close, opened));
  return fails ? failWith(ENOSPC) : result;
}

namespace shoal::mapping {
namespace {

class AtomicFileTest : public testing::Test {
 protected:
  AtomicFileTest() : folder_(testing::TempDir() + "shoal_atomic_" + std::to_string(::getpid())) {
    writeFileAtomically(path(), "before");
    flushed.clear();
  }
  ~AtomicFileTest() override {
    file_fails = folder_fails = close_fails = false;
    std::filesystem::remove_all(folder_);
  }
  std::string path() const { return folder_ + "/map.csv"; }

  // What is said when it cannot be written; the file is as before, and nothing else is left.
  std::string complaint() {
    std::string what;
    try {
      writeFileAtomically(path(), "after");
    } catch (const std::runtime_error& error) {
      what = error.what();
    }
    file_fails = close_fails = false;
    EXPECT_EQ(readFile(path()), "before");
    EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
    return what;
  }

  std::string folder_;
};

TEST_F(AtomicFileTest, FoldersAreMadeOrItIsSaidWhyNot) {
  makeFolder(folder_ + "/a/b");
  makeFolder(folder_ + "/a/b");
  EXPECT_TRUE(std::filesystem::is_directory(folder_ + "/a/b"));
  for (const auto& use : {std::function<void()>([&] { makeFolder(path() + "/c"); }),
                          std::function<void()>([&] { writeFileAtomically(path() + "/c/d", "lost"); })}) {
    try {
      use();
      ADD_FAILURE() << "a folder within a file";
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()), "cannot make the folder " + path() + "/c: Not a directory");
    }
  }
}

TEST_F(AtomicFileTest, IsOnTheDiskUnderItsNameWhenItReturns) {
  writeFileAtomically(path(), "after");
  EXPECT_EQ(readFile(path()), "after");
  EXPECT_EQ(flushed, (std::vector<std::string>{"file", "folder"}));
}

TEST_F(AtomicFileTest, ADiskThatCannotFlushLeavesTheFileAsItWas) {
  file_fails = true;
  const std::string what = complaint();
  EXPECT_NE(what.find("cannot write " + path()), std::string::npos) << what;
  EXPECT_NE(what.find("Input/output error"), std::string::npos) << what;
}

TEST_F(AtomicFileTest, ADiskThatIsFullWhenItClosesLeavesTheFileAsItWas) {
  close_fails = true;
  const std::string what = complaint();
  EXPECT_NE(what.find("cannot write " + path()), std::string::npos) << what;
  EXPECT_NE(what.find("No space left on device"), std::string::npos) << what;
}

TEST_F(AtomicFileTest, ALinkGoesOnLeadingToTheFile) {
  const std::string link = folder_ + "/latest.csv";
  std::filesystem::create_symlink("map.csv", link);
  writeFileAtomically(link, "after");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
  EXPECT_FALSE(std::filesystem::is_symlink(path()));
  EXPECT_EQ(readFile(path()), "after");
}

TEST_F(AtomicFileTest, APipeIsWrittenIntoAndStaysOne) {
  const std::string pipe = folder_ + "/pipe";
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  std::string read(5, ' ');
  std::thread reader([&] { std::ifstream(pipe).read(read.data(), 5); });
  writeFileAtomically(pipe, "after");
  reader.join();
  EXPECT_EQ(read, "after");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
}

TEST_F(AtomicFileTest, AFolderThatCannotBeFlushedIsNoError) {
  folder_fails = true;
  EXPECT_NO_THROW(writeFileAtomically(path(), "after"));
  EXPECT_EQ(readFile(path()), "after");
}

TEST_F(AtomicFileTest, ANameThatIsTakenByAFolderIsAnErrorThatLeavesNothingBehind) {
  EXPECT_THROW(writeFileAtomically(folder_, "after"), std::runtime_error);
  for (const auto& entry : std::filesystem::directory_iterator(testing::TempDir()))
    EXPECT_FALSE(entry.path().string().starts_with(folder_ + ".tmp")) << entry.path();
}

}  // namespace
}  // namespace shoal::mapping
