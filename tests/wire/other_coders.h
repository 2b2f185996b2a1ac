// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "shoal/mapping/piece.h"

namespace shoal::wire {

using Cells = std::span<const mapping::BrickCell>;  // ascending; labels below 255 in place of topics

/// One byte a column (x, y), from its highest cell; 255 where there is none.
struct Raster {
  int width = 0, height = 0;
  std::vector<uint8_t> pixels;
};
Raster rasterOf(Cells cells);

/// What general coders make of maps, bytes. 0 when the program is not installed.
size_t zstd19(const std::vector<uint8_t>& bytes);
size_t jpegXl(const Raster& raster);  ///< lossless, cjxl -d 0 -e 9
size_t draco(Cells cells);            ///< a point cloud, labels as red, draco_encoder -qp 10 -cl 10
size_t octoMap(Cells cells);          ///< ColorOcTree, as its .ot file

}  // namespace shoal::wire
