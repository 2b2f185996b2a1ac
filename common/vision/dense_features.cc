// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/dense_features.h"

#include <algorithm>
#include <span>

#include "shoal/demand.h"
#include "shoal/vision/color_blocks.h"
#include "shoal/vision/fixed_math.h"
#include "shoal/vision/texture_blocks.h"

namespace shoal::vision {
namespace {

constexpr int kNumLevels = 3;
constexpr int kRatioBits = 10;  // of log ratios of channels, and of shares and coherence
constexpr int kEnergyBits = 7;  // of log energies and variances
constexpr int64_t kDarkest =
    32;  // added to mean channels, 2 of 256 levels: keeps ratios of nearly nothing calm
constexpr int64_t kStill = 64;  // added to mean energies: noise of smooth ground, (.8 % in log-luminance)^2
constexpr int64_t kPlain = 16;  // added to variances: half a CIE unit, squared, in steps of 1/64
constexpr int64_t kFaint = 8;   // mean edge strength that counts as of no direction

using ColorWindow = BlockSums<kNumColorSums>::Window;
using TextureWindow = TextureBlocks::Window;

int16_t feature(int64_t value) {
  return static_cast<int16_t>(std::clamp<int64_t>(value, -kMaxFeature, kMaxFeature));
}

int64_t roundedMean(int64_t sum, int64_t count) {
  const int64_t twice = 2 * sum + count;  // floor of sum / count + 1/2
  return twice >= 0 ? twice / (2 * count) : -((2 * count - 1 - twice) / (2 * count));
}

int32_t logOf(int64_t x, int bits) { return fixedLog2(static_cast<uint64_t>(x), bits); }

void appendMeanColor(const BlockSums<kNumColorSums>::Sums& sums, int64_t pixels, std::vector<int16_t>& out) {
  for (const ColorSum channel : {kL, kA, kB}) out.push_back(feature(roundedMean(sums[channel], pixels)));
}

void appendChromaticity(const ColorWindow& window, int64_t pixels, std::vector<int16_t>& out) {
  const auto log = [&](ColorSum channel) {
    return logOf(window.sums[channel] + kDarkest * pixels, kRatioBits);
  };
  out.push_back(feature(log(kRed) - log(kGreen)));
  out.push_back(feature(log(kBlue) - log(kGreen)));
}

void appendDeviation(const ColorWindow& window, int64_t pixels, std::vector<int16_t>& out) {
  for (size_t channel = 0; channel < 3; ++channel) {
    const int64_t sum = window.sums[kL + channel];
    // pixels^2 times the variance.
    const int64_t spread = pixels * window.sums[kLSquared + channel] - sum * sum;
    out.push_back(feature(logOf(spread / (pixels * pixels) + kPlain, kEnergyBits)));
  }
}

// (sqrt((xx - yy)^2 + 4 xy^2)) / (xx + yy): 1 when all edges run alike, 0 when none prevails.
int64_t coherence(const TextureWindow& window, int64_t pixels) {
  const int64_t xx = window.sums[kXX] / pixels, yy = window.sums[kYY] / pixels,
                xy = window.sums[kXY] / pixels;
  const int64_t across = xx - yy, along = 2 * xy;
  const auto anisotropy =
      static_cast<int64_t>(integerSquareRoot(static_cast<uint64_t>(across * across + along * along)));
  return (anisotropy << kRatioBits) / (xx + yy + kStill);
}

void appendTexture(const std::array<TextureWindow, kNumLevels>& windows,
                   const std::array<int64_t, kNumLevels>& pixels, std::vector<int16_t>& out) {
  const auto energy = [&](size_t level, int64_t sum) {
    return feature(logOf(sum / pixels[level] + kStill, kEnergyBits));
  };
  for (size_t level = 0; level < kNumLevels; ++level)
    out.push_back(energy(level, windows[level].sums[kBlob]));
  for (size_t level = 0; level < kNumLevels; ++level) {
    out.push_back(energy(level, windows[level].sums[kXX] + windows[level].sums[kYY]));
  }
  for (size_t level = 0; level < 2; ++level) out.push_back(feature(coherence(windows[level], pixels[level])));
}

// The square root of part / whole.
int16_t rootOfShare(int64_t part, int64_t whole) {
  return feature(
      static_cast<int64_t>(integerSquareRoot(static_cast<uint64_t>((part << (2 * kRatioBits)) / whole))));
}

void appendDirections(const TextureWindow& window, int64_t pixels, std::vector<int16_t>& out) {
  const std::span<const int64_t> strengths = std::span(window.sums).subspan(kFirstDirection, kNumDirections);
  int64_t whole = kFaint * pixels;
  for (const int64_t strength : strengths) whole += strength;
  const auto strongest = std::max_element(strengths.begin(), strengths.end()) - strengths.begin();
  for (int n = 0; n < kNumDirections; ++n) {
    out.push_back(rootOfShare(strengths[static_cast<size_t>((strongest + n) % kNumDirections)], whole));
  }
}

void appendPatterns(const TextureWindow& window, int64_t pixels, std::vector<int16_t>& out) {
  for (size_t n = 0; n < kNumPatterns; ++n)
    out.push_back(rootOfShare(window.sums[kFirstPattern + n], pixels));
}

}  // namespace

DenseFeatures denseFeatures(const cv::Mat& bgr, const ChannelResponses& responses) {
  const CorrectedPicture picture = correct(bgr, responses);
  const Plane half = halved(picture.log_luminance);
  const std::array<TextureBlocks, kNumLevels> levels{textureBlocks(picture.log_luminance, kBlockSize),
                                                     textureBlocks(half, kBlockSize / 2),
                                                     textureBlocks(halved(half), kBlockSize / 4)};
  DenseFeatures features{picture.colors.columns(), picture.colors.rows(), {}};
  for (size_t kind = 0; kind < kNumFeatureKinds; ++kind) {
    features.values[kind].reserve(features.numPoints() * static_cast<size_t>(kFeatureKinds[kind].dimensions));
  }
  for (int j = 0; j < features.rows; ++j) {
    for (int i = 0; i < features.columns; ++i) {
      auto& values = features.values;
      const ColorWindow colors = picture.colors.window(i, j);
      std::array<TextureWindow, kNumLevels> textures;
      std::array<int64_t, kNumLevels> pixels;
      for (size_t level = 0; level < kNumLevels; ++level) {
        textures[level] = levels[level].window(i, j);
        pixels[level] = textures[level].num_blocks * ((kBlockSize >> level) * (kBlockSize >> level));
      }
      appendMeanColor(colors.sums, pixels[0], values[kLab24]);
      appendMeanColor(picture.colors.at(i, j), kBlockSize * kBlockSize, values[kLab8]);
      appendChromaticity(colors, pixels[0], values[kChr24]);
      appendTexture(textures, pixels, values[kTex]);
      for (size_t level = 0; level < 2; ++level)
        appendDirections(textures[level], pixels[level], values[kHog]);
      for (size_t level = 0; level < kNumLevels; ++level) {
        appendPatterns(textures[level], pixels[level], values[kLbp]);
      }
      appendDeviation(colors, pixels[0], values[kStd24]);
    }
  }
  return features;
}

}  // namespace shoal::vision
