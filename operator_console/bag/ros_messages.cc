// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/bag/ros_messages.h"

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "operator_console/bag/cdr_reader.h"

namespace shoal::console {
namespace {

constexpr uint32_t kMaxSide = 8192;
constexpr size_t kCompressedDepthHeader = 12;  // of compressed_depth_image_transport, before its PNG

std::optional<RosStamp> stampIn(CdrReader& cdr) {
  const int64_t seconds = cdr.i32();
  const int64_t nanoseconds = cdr.u32();
  cdr.string();  // frame
  if (!cdr.good() || seconds < 0 || nanoseconds >= 1'000'000'000) return std::nullopt;
  return RosStamp{seconds * 1'000'000 + nanoseconds / 1000};
}

struct Raw {
  uint32_t width = 0, height = 0, step = 0;
  std::string encoding;
  bool is_big = false;
  std::span<const uint8_t> data;
  std::span<const uint8_t> row(uint32_t y) const { return data.subspan(size_t{y} * step, step); }
};

cv::Mat colour(const Raw& raw, int channels, int conversion) {
  cv::Mat pixels(static_cast<int>(raw.height), static_cast<int>(raw.width), CV_MAKETYPE(CV_8U, channels));
  for (uint32_t y = 0; y < raw.height; ++y) {
    const auto row = raw.row(y).first(size_t{raw.width} * static_cast<size_t>(channels));
    std::copy(row.begin(), row.end(), pixels.ptr<uint8_t>(static_cast<int>(y)));
  }
  if (conversion >= 0) cv::cvtColor(pixels, pixels, conversion);
  return pixels;
}

uint32_t value(const Raw& raw, std::span<const uint8_t> row, size_t x, size_t size) {
  uint32_t bits = 0;
  for (size_t i = 0; i < size; ++i) bits = bits << 8 | row[x * size + (raw.is_big ? i : size - 1 - i)];
  return bits;
}

uint16_t millimetres(float metres) {
  if (!std::isfinite(metres) || metres <= 0) return 0;
  const double mm = std::round(static_cast<double>(metres) * 1000);
  return mm > 65534 ? uint16_t{0} : static_cast<uint16_t>(mm);  // farther than can be said is no depth
}

cv::Mat depthOf(const Raw& raw, size_t size) {
  cv::Mat depth(static_cast<int>(raw.height), static_cast<int>(raw.width), CV_16UC1);
  for (uint32_t y = 0; y < raw.height; ++y) {
    auto* to = depth.ptr<uint16_t>(static_cast<int>(y));
    for (size_t x = 0; x < raw.width; ++x) {
      const uint32_t bits = value(raw, raw.row(y), x, size);
      to[x] = size == 2 ? static_cast<uint16_t>(bits) : millimetres(std::bit_cast<float>(bits));
    }
  }
  return depth;
}

// Bytes of a pixel; 0 for an encoding that is not read.
size_t pixelBytes(const std::string& encoding, bool depth) {
  if (depth) return encoding == "16UC1" || encoding == "mono16" ? 2 : encoding == "32FC1" ? 4 : 0;
  if (encoding == "mono8" || encoding == "8UC1") return 1;
  if (encoding == "rgb8" || encoding == "bgr8" || encoding == "8UC3") return 3;
  return encoding == "rgba8" || encoding == "bgra8" ? 4 : 0;
}

}  // namespace

std::optional<RosPicture> readImage(std::span<const uint8_t> bytes, bool depth, std::string& trouble) {
  CdrReader cdr(bytes);
  const auto stamp = stampIn(cdr);
  Raw raw;
  raw.height = cdr.u32();
  raw.width = cdr.u32();
  raw.encoding = cdr.string();
  raw.is_big = cdr.u8() != 0;
  raw.step = cdr.u32();
  raw.data = cdr.bytes();
  if (!stamp || !cdr.good()) {
    trouble = "no image message";
    return std::nullopt;
  }
  const size_t pixel = pixelBytes(raw.encoding, depth);
  if (pixel == 0) {
    trouble = "encoding \"" + raw.encoding + "\" is not read as " + (depth ? "depth" : "colour");
    return std::nullopt;
  }
  if (raw.width == 0 || raw.height == 0 || raw.width > kMaxSide || raw.height > kMaxSide ||
      raw.step < raw.width * pixel || raw.data.size() / raw.step < raw.height) {
    trouble = "size and data of an image do not go together";
    return std::nullopt;
  }
  if (depth) return RosPicture{*stamp, depthOf(raw, pixel)};
  const int conversion = pixel == 1                ? cv::COLOR_GRAY2BGR
                         : raw.encoding == "rgb8"  ? cv::COLOR_RGB2BGR
                         : raw.encoding == "rgba8" ? cv::COLOR_RGBA2BGR
                         : raw.encoding == "bgra8" ? cv::COLOR_BGRA2BGR
                                                   : -1;
  return RosPicture{*stamp, colour(raw, static_cast<int>(pixel), conversion)};
}

std::optional<RosPicture> readCompressedImage(std::span<const uint8_t> bytes, bool depth,
                                              std::string& trouble) {
  CdrReader cdr(bytes);
  const auto stamp = stampIn(cdr);
  const std::string format = cdr.string();
  std::span<const uint8_t> data = cdr.bytes();
  if (!stamp || !cdr.good()) {
    trouble = "no compressed image message";
    return std::nullopt;
  }
  if (depth) {
    if (!format.starts_with("16UC1") || format.find("compressedDepth") == std::string::npos ||
        data.size() <= kCompressedDepthHeader) {
      trouble = "format \"" + format + "\" is not read as depth";
      return std::nullopt;
    }
    data = data.subspan(kCompressedDepthHeader);
  }
  cv::Mat pixels;
  try {
    if (!data.empty()) {
      pixels = cv::imdecode(std::vector<uint8_t>(data.begin(), data.end()),
                            depth ? cv::IMREAD_UNCHANGED : cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
    }
  } catch (const cv::Exception&) {  // absurd sizes
    pixels.release();
  }
  const bool good = pixels.type() == (depth ? CV_16UC1 : CV_8UC3) && !pixels.empty() &&
                    std::max(pixels.cols, pixels.rows) <= static_cast<int>(kMaxSide);
  if (!good) {
    trouble = "a compressed image (format \"" + format + "\") cannot be decoded";
    return std::nullopt;
  }
  return RosPicture{*stamp, pixels};
}

std::optional<RosCamera> readCameraInfo(std::span<const uint8_t> bytes, std::string& trouble) {
  CdrReader cdr(bytes);
  const auto stamp = stampIn(cdr);
  RosCamera camera;
  camera.height = cdr.u32();
  camera.width = cdr.u32();
  cdr.string();  // distortion model
  camera.distorted = cdr.anyOfDoubles();
  std::array<double, 9> k{};
  for (double& entry : k) entry = cdr.f64();
  camera.fx = k[0];
  camera.cx = k[2];
  camera.fy = k[4];
  camera.cy = k[5];
  const bool sane = std::isfinite(camera.fx) && std::isfinite(camera.fy) && std::isfinite(camera.cx) &&
                    std::isfinite(camera.cy) && camera.fx > 0 && camera.fy > 0 && camera.width > 0 &&
                    camera.height > 0 && camera.width <= kMaxSide && camera.height <= kMaxSide;
  if (!stamp || !cdr.good() || !sane) {
    trouble = "no camera info with a K";
    return std::nullopt;
  }
  return camera;
}

std::optional<RosPose> readPose(std::span<const uint8_t> bytes, bool odometry, std::string& trouble) {
  CdrReader cdr(bytes);
  const auto stamp = stampIn(cdr);
  if (odometry) cdr.string();  // child frame
  RosPose pose;
  for (double& entry : pose.position) entry = cdr.f64();
  double norm = 0;
  for (double& entry : pose.orientation) {
    entry = cdr.f64();
    norm += entry * entry;
  }
  bool sane = std::abs(norm - 1) < 0.1;
  for (const double entry : pose.position) sane = sane && std::isfinite(entry);
  if (!stamp || !cdr.good() || !sane) {
    trouble = "no pose message with a rotation";
    return std::nullopt;
  }
  pose.stamp = *stamp;
  return pose;
}

}  // namespace shoal::console
