// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_camera.h"

#include <algorithm>

#include "shoal/random.h"

namespace shoal::world {
namespace {

/// e^-x for small x >= 0, by additions and products alone: alike on every machine.
float decay(float x) { return 1.0f - x * (1.0f - x * (0.5f - x * (1.0f / 6 - x / 24))); }

}  // namespace

WaterColumn::WaterColumn(const Water& water) {
  constexpr Color kWhiteBalance{1.70f, 1.11f, 1.12f};  // of a diver's camera
  Color kept = kWhiteBalance, clear{1.0f, 1.0f, 1.0f};
  for (Effect& effect : table_) {
    for (size_t c = 0; c < 3; ++c) {
      effect.kept[c] = kept[c];
      effect.added[c] = water.veil[c] * (1.0f - clear[c]);
      kept[c] *= decay(water.attenuation[c] / kPerMetre);
      clear[c] *= decay(water.backscatter[c] / kPerMetre);
    }
  }
}

void Film::expose() {
  constexpr float kUsual = 0.42f, kPart = 0.4f;
  double sum = 0.0, lit = 0.0;
  for (const Color& c : light_) {
    sum += static_cast<double>(c[1]);
    lit += c[1] > 0.0f;
  }
  if (lit == 0.0) return;
  const float mean = static_cast<float>(sum / lit);
  const float gain = 1.0f / (1.0f - kPart + kPart * mean / kUsual);
  for (Color& c : light_) {
    for (float& channel : c) channel *= gain;
  }
}

void Film::soften() {
  constexpr float kAside = 0.14f, kMiddle = 1.0f - 2.0f * kAside;
  std::vector<Color> across(light_.size());
  const size_t width = static_cast<size_t>(width_), last = light_.size() - width;
  const auto blend = [](const Color& a, const Color& b, const Color& c) {
    return Color{kMiddle * b[0] + kAside * (a[0] + c[0]), kMiddle * b[1] + kAside * (a[1] + c[1]),
                 kMiddle * b[2] + kAside * (a[2] + c[2])};
  };
  for (size_t row = 0; row < light_.size(); row += width) {
    for (size_t i = 0; i < width; ++i) {
      across[row + i] = blend(light_[row + (i == 0 ? 0 : i - 1)], light_[row + i],
                              light_[row + std::min(i + 1, width - 1)]);
    }
  }
  for (size_t row = 0; row < light_.size(); row += width) {
    const Color* above = across.data() + (row == 0 ? 0 : row - width);
    const Color* here = across.data() + row;
    const Color* below = across.data() + std::min(row + width, last);
    for (size_t i = 0; i < width; ++i) light_[row + i] = blend(above[i], here[i], below[i]);
  }
}

cv::Mat Film::develop(uint64_t key) const {
  cv::Mat picture(height_, width_, CV_8UC3);
  for (int v = 0; v < height_; ++v) {
    cv::Vec3b* row = picture.ptr<cv::Vec3b>(v);
    const Color* light = light_.data() + static_cast<size_t>(v) * static_cast<size_t>(width_);
    for (int u = 0; u < width_; ++u) {
      // Two 10-bit draws a channel make triangular noise, two grey levels of it in the dark, four in the
      // light.
      const uint64_t grain = mix64(key + static_cast<uint64_t>(v) * 65536 + static_cast<uint64_t>(u));
      for (size_t c = 0; c < 3; ++c) {
        const auto draw = [&](size_t i) { return static_cast<int>(grain >> (10 * i) & 1023); };
        const float noise = static_cast<float>(draw(2 * c) + draw(2 * c + 1) - 1023) * (1.0f / 1023.0f);
        const float value = 255.0f * light[u][c] + noise * (4.0f + 6.0f * light[u][c]) + 0.5f;
        row[u][static_cast<int>(2 - c)] = static_cast<uint8_t>(std::clamp(value, 0.0f, 255.0f));
      }
    }
  }
  return picture;
}

}  // namespace shoal::world
