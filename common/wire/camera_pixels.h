// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <opencv2/core/mat.hpp>

#include "shoal/wire/camera_codec.h"

namespace shoal::wire {

// Pixels as received become pictures. Nothing is allocated, nor a decompressor asked, before the bytes are
// known to make a picture of exactly width x height.

/// A colour picture, CV_8UC3, BGR, from RGB, BGR, GRAY or MJPEG (one JPEG picture).
/// @returns kUnknownFormat for another pixel format, kBadPayload when the bytes are no such picture.
Result<cv::Mat> colorFrom(const ImageView& image);

/// A depth picture as sent, CV_16UC1, from LE_GRAY16.
Result<cv::Mat> depthFrom(const ImageView& image);

/// The same from DEPTH_MM_ZIPPED: rows without gaps, least significant byte first, compressed by zlib.
Result<cv::Mat> unzippedDepthFrom(const ImageView& image);

/// Pixels as a message takes them, in place: BGR from CV_8UC3, LE_GRAY16 from CV_16UC1.
/// @param picture  continuous; must outlive the view.
ImageView viewOf(const cv::Mat& picture, world::Timestamp time);

}  // namespace shoal::wire
