// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/camera_pixels.h"

#include <algorithm>
#include <bit>
#include <optional>

#include <zlib.h>
#include <opencv2/imgcodecs.hpp>

#include "shoal/demand.h"

namespace shoal::wire {
namespace {

static_assert(std::endian::native == std::endian::little, "16-bit pixels are copied as they are");

/// The rows of an uncompressed picture, when all of them are there; `pixel_bytes` a pixel.
class Rows {
 public:
  Rows(const ImageView& image, size_t pixel_bytes)
      : row_bytes_(static_cast<size_t>(image.width) * pixel_bytes),
        stride_(image.row_stride == 0 ? row_bytes_ : static_cast<size_t>(image.row_stride)),
        data_(image.data),
        whole_(stride_ >= row_bytes_ &&
               data_.size() >= stride_ * (static_cast<size_t>(image.height) - 1) + row_bytes_) {}

  bool areWhole() const { return whole_; }
  std::span<const uint8_t> operator[](int row) const {
    return data_.subspan(static_cast<size_t>(row) * stride_, row_bytes_);
  }

 private:
  size_t row_bytes_, stride_;
  std::span<const uint8_t> data_;
  bool whole_;
};

/// The size that a JPEG picture says it has, from its frame header (ITU-T T.81, B.2.2); nothing when it has
/// none.
std::optional<cv::Size> jpegSize(std::span<const uint8_t> data) {
  if (data.size() < 4 || data[0] != 0xff || data[1] != 0xd8) return std::nullopt;
  size_t at = 2;
  while (at + 9 <= data.size()) {
    if (data[at] != 0xff) return std::nullopt;
    const uint8_t marker = data[at + 1];
    if (marker == 0xff) {  // padding
      ++at;
      continue;
    }
    const bool is_frame =
        marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc;
    if (is_frame) {
      return cv::Size(static_cast<int>(bigEndian(data.subspan(at + 7, 2))),
                      static_cast<int>(bigEndian(data.subspan(at + 5, 2))));
    }
    const size_t length = bigEndian(data.subspan(at + 2, 2));
    if (marker == 0xda || length < 2) return std::nullopt;  // pixels before any frame
    at += 2 + length;
  }
  return std::nullopt;
}

cv::Mat emptyPicture(const ImageView& image, int type) { return cv::Mat(image.height, image.width, type); }

Result<cv::Mat> jpeg(const ImageView& image) {
  if (jpegSize(image.data) != cv::Size(image.width, image.height)) return DecodeError::kBadPayload;
  try {
    const cv::Mat bytes(1, static_cast<int>(image.data.size()), CV_8UC1,
                        const_cast<uint8_t*>(image.data.data()));  // OpenCV has no const view; it only reads
    cv::Mat picture = cv::imdecode(bytes, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION);
    const bool good = picture.type() == CV_8UC3 && picture.size() == cv::Size(image.width, image.height);
    if (!good) return DecodeError::kBadPayload;
    return picture;
  } catch (const cv::Exception&) {
    return DecodeError::kBadPayload;
  }
}

}  // namespace

Result<cv::Mat> colorFrom(const ImageView& image) {
  const auto format = static_cast<PixelFormat>(image.pixel_format);
  if (format == PixelFormat::kMjpeg) return jpeg(image);
  if (format != PixelFormat::kRgb && format != PixelFormat::kBgr && format != PixelFormat::kGray) {
    return DecodeError::kUnknownFormat;
  }
  const Rows rows(image, format == PixelFormat::kGray ? 1 : 3);
  if (!rows.areWhole()) return DecodeError::kBadPayload;
  cv::Mat picture = emptyPicture(image, CV_8UC3);
  for (int v = 0; v < image.height; ++v) {
    const uint8_t* from = rows[v].data();
    auto* to = picture.ptr<cv::Vec3b>(v);
    for (int u = 0; u < image.width; ++u) {
      if (format == PixelFormat::kGray) {
        to[u] = cv::Vec3b::all(from[u]);
      } else if (format == PixelFormat::kRgb) {
        to[u] = {from[3 * u + 2], from[3 * u + 1], from[3 * u]};
      } else {
        to[u] = {from[3 * u], from[3 * u + 1], from[3 * u + 2]};
      }
    }
  }
  return picture;
}

Result<cv::Mat> depthFrom(const ImageView& image) {
  if (image.pixel_format != static_cast<int32_t>(PixelFormat::kGray16)) return DecodeError::kUnknownFormat;
  const Rows rows(image, 2);
  if (!rows.areWhole()) return DecodeError::kBadPayload;
  cv::Mat picture = emptyPicture(image, CV_16UC1);
  for (int v = 0; v < image.height; ++v) std::ranges::copy(rows[v], picture.ptr<uint8_t>(v));
  return picture;
}

Result<cv::Mat> unzippedDepthFrom(const ImageView& image) {
  // zlib packs at most about 1032 bytes into one: less cannot make the picture.
  const auto size = static_cast<uLong>(image.width) * static_cast<uLong>(image.height) * 2;
  if (image.data.empty() || size / 1100 > image.data.size()) return DecodeError::kBadPayload;
  cv::Mat picture = emptyPicture(image, CV_16UC1);
  uLongf written = size;
  const int status =
      uncompress(picture.ptr<uint8_t>(), &written, image.data.data(), static_cast<uLong>(image.data.size()));
  if (status != Z_OK || written != size) return DecodeError::kBadPayload;
  return picture;
}

ImageView viewOf(const cv::Mat& picture, world::Timestamp time) {
  SHOAL_DEMAND(picture.isContinuous() && (picture.type() == CV_8UC3 || picture.type() == CV_16UC1));
  const auto format = picture.type() == CV_8UC3 ? PixelFormat::kBgr : PixelFormat::kGray16;
  return {time,
          picture.cols,
          picture.rows,
          static_cast<int32_t>(picture.step[0]),
          static_cast<int32_t>(format),
          {picture.ptr<uint8_t>(), picture.total() * picture.elemSize()}};
}

}  // namespace shoal::wire
