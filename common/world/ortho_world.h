// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include <opencv2/core/mat.hpp>

#include "shoal/world/world.h"

namespace shoal::world {

/// One big top-down picture, perhaps with a class for every pixel, as a flat world at Z = 0.
///
/// Pixel (px, py) is centred at X = px x metres per pixel, Y = -py x metres per pixel, so that the extent
/// begins half a pixel outside the origin.
class OrthoWorld final : public World {
 public:
  /// @param color   rows x columns, CV_8UC3, BGR, not empty.
  /// @param labels  the same size, CV_8UC1, class ids and 255; empty when nothing is labelled.
  /// @param metres_per_pixel  finite, > 0.
  /// @throws std::invalid_argument when one of them is not so, or a label is of no class.
  OrthoWorld(std::string name, cv::Mat color, cv::Mat labels, double metres_per_pixel,
             std::vector<TruthClass> classes);

  const std::string& name() const override { return name_; }
  Extent extent() const override;
  double metresPerPixel() const override { return metres_per_pixel_; }
  double defaultCellSize() const override { return 24.0 * metres_per_pixel_; }
  const std::vector<TruthClass>& classes() const override { return classes_; }

  /// Bilinear colour and nearest label where a pixel's ray meets the picture; no depth, black and 255 where
  /// it does not. Coarser views than the picture alias. Cost: O(pixels).
  Observation render(const Intrinsics& intrinsics, const Pose& world_from_camera) const override;

  /// Cells on the border between two pixels' centres hold whole pixels; the cell's z is ignored.
  std::optional<uint8_t> truthOfSquare(const Grid& grid, const CellIndex& cell) const override;
  bool hasFlatTruth() const override { return !labels_.empty(); }

 private:
  std::string name_;
  cv::Mat color_;   // BGR
  cv::Mat labels_;  // empty, or as large as color_
  double metres_per_pixel_;
  std::vector<TruthClass> classes_;
};

}  // namespace shoal::world
