// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shoal::world {

/// What the surface of a thing on the seabed looks like from close by, colour aside. kEdge and kCaustics are
/// no surfaces: how far borders wander; how waves focus the light (brightness about 0, lines of light up to
/// 1).
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
  kEdge,
  kCaustics
};

/// A square of surface that repeats seamlessly, precomputed with one texel per 4 cm.
class TextureTile {
 public:
  static constexpr float kTexelsPerMetre = 25.0f;

  /// What the tile holds at a point.
  struct Sample {
    float brightness;      ///< lighter or darker than the mean, [-1, 1]
    float mix;             ///< towards the first (-1) or the second (1) colour
    float rise_x, rise_y;  ///< slope of the relief, [-1, 1]
  };

  TextureTile(Texture texture, uint64_t seed);

  /// Bilinear, to a sixteenth of a texel; x and y in metres, above -1000 m.
  Sample at(float x_m, float y_m) const {
    constexpr float kOffset = 1 << 15;  // a whole number of tiles; makes truncation rounding down
    const uint32_t x = static_cast<uint32_t>((x_m * kTexelsPerMetre + kOffset) * 16.0f),
                   y = static_cast<uint32_t>((y_m * kTexelsPerMetre + kOffset) * 16.0f);
    const uint32_t x0 = (x >> 4) & mask_, x1 = ((x >> 4) + 1) & mask_;
    const Texel* top = texels_.data() + static_cast<size_t>((y >> 4) & mask_) * side();
    const Texel* bottom = texels_.data() + static_cast<size_t>(((y >> 4) + 1) & mask_) * side();
    const uint64_t fx = x & 15, fy = y & 15;
    // All four lanes at once: the weights add up to 256, so that no lane runs over.
    const uint64_t sum =
        (16 - fy) * ((16 - fx) * top[x0] + fx * top[x1]) + fy * ((16 - fx) * bottom[x0] + fx * bottom[x1]);
    const auto lane = [&](int i) {
      return static_cast<float>(static_cast<int>(sum >> (16 * i) & 0xffff)) * (1.0f / 256 / 127) -
             128.0f / 127;
    };
    return {lane(0), lane(1), lane(2), lane(3)};
  }

 private:
  /// Brightness, mix and slopes, the lowest first, in lanes of 16 bits: 128 + 127 x value.
  using Texel = uint64_t;
  size_t side() const { return static_cast<size_t>(mask_) + 1; }

  uint32_t mask_;  // side - 1, the side a power of two
  std::vector<Texel> texels_;
};

}  // namespace shoal::world
