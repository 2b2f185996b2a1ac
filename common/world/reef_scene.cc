// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_scene.h"

#include <algorithm>
#include <utility>

namespace shoal::world {

ReefScene::ReefScene(ReefStyle style, uint64_t seed)
    : style_(std::move(style)),
      fields_(style_, seed),
      garden_(style_, fields_),
      edges_(Texture::kEdge, fields_.key()),
      caustics_(Texture::kCaustics, fields_.key()) {
  for (const ReefClass& c : style_.classes) textures_.emplace_back(c.texture, fields_.key());
}

float ReefScene::groundHeight(float x, float y) const {
  const int last = fields_.meshNodes() - 2;
  const float cx = x / ReefFields::kHeightSpacing, cy = -y / ReefFields::kHeightSpacing;
  const int ix = std::clamp(static_cast<int>(cx), 0, last), iy = std::clamp(static_cast<int>(cy), 0, last);
  const float fx = cx - static_cast<float>(ix), fy = cy - static_cast<float>(iy);
  const float north_east = fields_.meshHeight(ix + 1, iy), south_west = fields_.meshHeight(ix, iy + 1);
  if (fx + fy < 1.0f) {
    const float north_west = fields_.meshHeight(ix, iy);
    return north_west + fx * (north_east - north_west) + fy * (south_west - north_west);
  }
  const float south_east = fields_.meshHeight(ix + 1, iy + 1);
  return south_east + (1.0f - fx) * (south_west - south_east) + (1.0f - fy) * (north_east - south_east);
}

}  // namespace shoal::world
