// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as the world.json of a folder that holds image.png and labels.png, 4 x 3 pixels each: refused
// with a reason, or a world of that size.
//
//     fuzz_world -max_total_time=60 -max_len=1024
#include <unistd.h>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>

#include "shoal/world/world_folder.h"

namespace {

namespace fs = std::filesystem;

// Removed when the process ends in good order.
class Folder {
 public:
  Folder() : path_(fs::temp_directory_path() / ("shoal_fuzz_world_" + std::to_string(getpid()))) {
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    fs::create_directories(path_);
    cv::imwrite((path_ / "image.png").string(), cv::Mat(3, 4, CV_8UC3, cv::Scalar(10, 20, 30)));
    cv::imwrite((path_ / "labels.png").string(), cv::Mat(3, 4, CV_8UC1, cv::Scalar(1)));
  }
  ~Folder() { fs::remove_all(path_); }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static const Folder folder;
  std::ofstream(folder.path() / "world.json", std::ios::binary)
      .write(reinterpret_cast<const char*>(data), static_cast<std::streamsize>(size));
  try {
    const auto world = shoal::world::readWorldFolder(folder.path());
    if (world == nullptr) std::abort();
  } catch (const std::invalid_argument& error) {
    if (std::string(error.what()).find(folder.path().string()) == std::string::npos) std::abort();
  }
  return 0;
}
