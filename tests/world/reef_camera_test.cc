// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/world/reef_camera.h"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

namespace shoal::world {
namespace {

// J e^(-a r) + V (1 - e^(-b r)), J as the white balance leaves it; the table steps by a sixteenth of a metre.
TEST(WaterColumnTest, FadesColorsAndAddsItsOwnAsTheFormulaSays) {
  const Water water;
  const WaterColumn column(water);
  const Color near = column.seen({1, 1, 1}, 0.0f);
  for (const float range : {0.5f, 4.0f, 8.0f, 25.0f, 60.0f}) {
    const Color black = column.seen({0, 0, 0}, range), white = column.seen({1, 1, 1}, range);
    for (size_t c = 0; c < 3; ++c) {
      EXPECT_NEAR(black[c], water.veil[c] * (1 - std::exp(-water.backscatter[c] * range)), 1e-3);
      EXPECT_NEAR(white[c] - black[c], near[c] * std::exp(-water.attenuation[c] * range), 1e-3);
    }
  }
  EXPECT_EQ(column.seen({1, 1, 1}, 64.0f), column.seen({1, 1, 1}, 1e6f));
  const Color far = column.seen({1, 1, 1}, 8.0f);
  EXPECT_LT(far[0] / near[0], 0.8f * far[2] / near[2]);  // red goes first
}

TEST(FilmTest, SpreadsLightOverNeighborsAndLosesNone) {
  Film film(7, 5);
  film.at(2, 3) = {1, 1, 1};
  film.soften();
  float sum = 0;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 7; ++column) {
      const float light = film.at(row, column)[1];
      sum += light;
      EXPECT_EQ(light > 0, std::abs(row - 2) <= 1 && std::abs(column - 3) <= 1);
    }
  }
  EXPECT_NEAR(sum, 1, 1e-6);
  EXPECT_EQ(film.at(2, 2)[0], film.at(1, 3)[0]);
  EXPECT_GT(film.at(2, 3)[0], 0.4f);
}

TEST(FilmTest, MakesUpForAPartOfWhatIsDarkOrBright) {
  float after[2];
  for (int i = 0; i < 2; ++i) {
    Film film(4, 4);
    for (int pixel = 0; pixel < 16; ++pixel) film.at(pixel / 4, pixel % 4) = {.3f, i == 0 ? .2f : .8f, .3f};
    film.expose();
    after[i] = film.at(1, 1)[1];
  }
  EXPECT_GT(after[0], .2f);
  EXPECT_LT(after[1], .8f);
  EXPECT_LT(after[0], after[1]);
  Film black(4, 4);
  black.expose();
  EXPECT_EQ(black.at(0, 0), Color{});
}

TEST(FilmTest, DevelopsGrayLevelsWithNoiseThatGrowsWithTheLight) {
  double deviation[2];
  for (int i = 0; i < 2; ++i) {
    Film film(100, 100);
    const float light = i == 0 ? .2f : .8f;
    for (int pixel = 0; pixel < 10000; ++pixel) film.at(pixel / 100, pixel % 100) = {light, .5f, light};
    const cv::Mat picture = film.develop(9);
    cv::Scalar mean, spread;
    cv::meanStdDev(picture, mean, spread);
    EXPECT_NEAR(mean[0], 255 * light, .3);
    EXPECT_NEAR(mean[1], 127.5, .3);
    deviation[i] = spread[0];
    EXPECT_EQ(cv::norm(picture, film.develop(9), cv::NORM_INF), 0);
    EXPECT_GT(cv::norm(picture, film.develop(10), cv::NORM_INF), 0);
  }
  // Triangular noise of +- 4 + 6 L grey levels has a deviation of 1 / sqrt(6) of that.
  EXPECT_NEAR(deviation[0], (4 + 6 * .2) / std::sqrt(6), .2);
  EXPECT_NEAR(deviation[1], (4 + 6 * .8) / std::sqrt(6), .2);
}

}  // namespace
}  // namespace shoal::world
