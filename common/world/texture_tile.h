// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shoal::world {

/// What the surface of a thing on the seabed looks like from above, colour aside.
enum class Texture {
  kSand,
  kRubble,
  kRock,
  kSeagrass,
  kAlgae,
  kBrainCoral,
  kBranchingCoral,
  kPlateCoral,
  kSponge,
  kEdge
};

/// A square of surface that repeats seamlessly, precomputed with one texel per 4 cm.
class TextureTile {
 public:
  static constexpr float kTexelsPerMetre = 25.0f;

  /// What the tile holds at a point: each in [-1, 1].
  struct Sample {
    float brightness;  ///< lighter or darker than the mean
    float mix;         ///< towards the first (-1) or the second (1) colour
  };

  TextureTile(Texture texture, uint64_t seed);

  /// Bilinear; x and y in metres, above -1000 m.
  Sample at(float x_m, float y_m) const {
    constexpr int kOffset = 1 << 15;  // a whole number of tiles; makes truncation rounding down
    const float x = x_m * kTexelsPerMetre + kOffset, y = y_m * kTexelsPerMetre + kOffset;
    const int x_floor = static_cast<int>(x), y_floor = static_cast<int>(y);
    const float fx = x - static_cast<float>(x_floor), fy = y - static_cast<float>(y_floor);
    const int x0 = x_floor & mask_, x1 = (x_floor + 1) & mask_;
    const Texel* top = texels_.data() + static_cast<size_t>(y_floor & mask_) * side();
    const Texel* bottom = texels_.data() + static_cast<size_t>((y_floor + 1) & mask_) * side();
    const float w00 = (1.0f - fx) * (1.0f - fy), w10 = fx * (1.0f - fy), w01 = (1.0f - fx) * fy,
                w11 = fx * fy;
    const auto blend = [&](size_t c) {
      return (w00 * top[x0][c] + w10 * top[x1][c] + w01 * bottom[x0][c] + w11 * bottom[x1][c]) *
             (1.0f / 127.0f);
    };
    return {blend(0), blend(1)};
  }

 private:
  using Texel = std::array<int8_t, 2>;  // brightness, mix; in 1 / 127
  size_t side() const { return static_cast<size_t>(mask_) + 1; }

  int mask_;  // side - 1, the side a power of two
  std::vector<Texel> texels_;
};

}  // namespace shoal::world
