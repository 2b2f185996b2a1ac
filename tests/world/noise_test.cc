// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/noise.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "shoal/random.h"
#include "shoal/world/coarse_map.h"
#include "shoal/world/texture_tile.h"

namespace shoal::world {
namespace {

TEST(NoiseTest, RepeatsAfterItsPeriodAndVanishesOnTheLattice) {
  Random random(1);
  for (int i = 0; i < 200; ++i) {
    // Sixty-fourths, so that adding the period is exact.
    const float x = static_cast<float>(random.below(640)) / 64,
                y = static_cast<float>(random.below(640)) / 64;
    EXPECT_EQ(gradientNoise(9, 10, x, y), gradientNoise(9, 10, x + 10, y - 20));
    EXPECT_EQ(fractalNoise(9, 10, 3, x, y), fractalNoise(9, 10, 3, x - 10, y + 10));
    EXPECT_EQ(cellularNoise(9, 10, x, y).site, cellularNoise(9, 10, x + 10, y - 10).site);
    EXPECT_EQ(gradientNoise(9, 10, std::floor(x), std::floor(y)), 0.0f);
  }
}

TEST(NoiseTest, HasMeanZeroAndStaysNearOne) {
  Random random(2);
  double sum = 0;
  float highest = 0;
  for (int i = 0; i < 20000; ++i) {
    const float n = fractalNoise(5, 64, 4, static_cast<float>(64 * random.uniform()),
                                 static_cast<float>(64 * random.uniform()));
    sum += n;
    highest = std::max(highest, std::abs(n));
  }
  EXPECT_NEAR(sum / 20000, 0.0, 0.03);
  EXPECT_GT(highest, 0.6f);
  EXPECT_LT(highest, 1.3f);
}

// Sites lie in the nine squares around, so the nearest is the nearest of all: by brute force over a small
// torus.
TEST(NoiseTest, KnowsTheNearerOfTwoSites) {
  Random random(3);
  for (int i = 0; i < 500; ++i) {
    const SiteDistances s = cellularNoise(4, 7, static_cast<float>(7 * random.uniform()),
                                          static_cast<float>(7 * random.uniform()));
    EXPECT_GE(s.nearest, 0.0f);
    EXPECT_LE(s.nearest, s.second);
    EXPECT_LT(s.nearest, 1.42f);  // the point's own square has a site
  }
}

TEST(NoiseTest, KnowsTheCosineToAFewThousandths) {
  for (int i = -3000; i <= 3000; ++i) {
    const float turns = static_cast<float>(i) / 777.0f;
    EXPECT_NEAR(cosineOfTurns(turns), std::cos(6.283185307179586 * static_cast<double>(turns)), 0.002);
  }
}

TEST(TextureTileTest, RepeatsSeamlesslyAndStaysInRange) {
  for (const Texture texture : {Texture::kSand, Texture::kRock, Texture::kEdge}) {
    const TextureTile tile(texture, 3);
    const float side = texture == Texture::kRock ? 10.24f : 20.48f;
    Random random(4);
    for (int i = 0; i < 300; ++i) {
      const float x = static_cast<float>(10 * random.uniform()),
                  y = static_cast<float>(10 * random.uniform());
      EXPECT_LE(std::abs(tile.at(x, y).brightness), 1.0f);
      EXPECT_LE(std::abs(tile.at(x, y).mix), 1.0f);
      EXPECT_NEAR(tile.at(x, y).brightness, tile.at(x + side, y + 3 * side).brightness, 0.01f);
    }
    // Across the seam it changes no more than elsewhere.
    float at_seam = 0, inside = 0;
    for (int i = 0; i < 200; ++i) {
      const float y = 0.04f * static_cast<float>(i);
      at_seam += std::abs(tile.at(side - 0.04f, y).mix - tile.at(side, y).mix);
      inside += std::abs(tile.at(5.0f, y).mix - tile.at(5.04f, y).mix);
    }
    EXPECT_LT(at_seam, 3.0f * inside + 1.0f);
  }
}

TEST(TextureTileTest, IsBilinearBetweenTexels) {
  const TextureTile tile(Texture::kRubble, 3);
  for (int i = 0; i < 200; ++i) {
    const float x = 0.04f * static_cast<float>(i), y = 0.04f * static_cast<float>(3 * i);
    const auto at = [&](float dx, float dy) { return tile.at(x + dx, y + dy).brightness; };
    EXPECT_NEAR(at(0.02f, 0), 0.5f * (at(0, 0) + at(0.04f, 0)), 0.01f);
    EXPECT_NEAR(at(0, 0.02f), 0.5f * (at(0, 0) + at(0, 0.04f)), 0.01f);
  }
}

// Slopes are those of the relief that made them, so they add up to nothing around the tile.
TEST(TextureTileTest, RisesAsMuchAsItFalls) {
  const TextureTile tile(Texture::kSand, 3);
  double sum = 0, most = 0;
  for (int i = 0; i < 512; ++i) {
    const float rise = tile.at(0.04f * static_cast<float>(i), 3.0f).rise_x;
    sum += static_cast<double>(rise);
    most = std::max(most, std::abs(static_cast<double>(rise)));
  }
  EXPECT_NEAR(sum / 512, 0, 0.004);
  EXPECT_GT(most, 0.1);
}

TEST(CoarseMapTest, IsBilinearBetweenNodesAndConstantBeyond) {
  const CoarseMap<2> map(4, 2.0f, [](float x, float y) { return std::array{3 * x + y, x * y}; });
  EXPECT_FLOAT_EQ(map.at(1.0f, 5.0f)[0], 8.0f);
  EXPECT_FLOAT_EQ(map.at(1.0f, 5.0f)[1], 5.0f);
  EXPECT_FLOAT_EQ(map.at(6.0f, 6.0f)[0], 24.0f);
  EXPECT_FLOAT_EQ(map.at(-7.0f, 4.0f)[0], 4.0f);
  EXPECT_FLOAT_EQ(map.at(99.0f, 99.0f)[1], 36.0f);
}

}  // namespace
}  // namespace shoal::world
