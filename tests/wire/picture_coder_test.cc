// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/picture_coder.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "shoal/random.h"
#include "shoal/wire/picture_message.h"
#include "shoal/wire/picture_pieces.h"
#include "shoal/wire/wavelet.h"

namespace shoal::wire {
namespace {

using Pixels = std::vector<uint8_t>;

template <typename Paint>
Pixels painted(Paint&& paint) {
  Pixels rgb;
  for (int y = 0; y < kPictureEdge; ++y)
    for (int x = 0; x < kPictureEdge; ++x)
      for (int c = 0; c < 3; ++c)
        rgb.push_back(static_cast<uint8_t>(std::clamp(static_cast<int>(paint(x, y, c)), 0, 255)));
  return rgb;
}

// Blots of several sizes on a slope: as hard as a picture of a reef.
Pixels blots(uint64_t seed) {
  Random random(seed);
  std::vector<std::array<double, 6>> blots;
  for (int i = 0; i < 12; ++i)
    blots.push_back({32 * random.uniform(), 32 * random.uniform(), 1 + 6 * random.uniform(),
                     160 * (random.uniform() - .5), 160 * (random.uniform() - .5),
                     160 * (random.uniform() - .5)});
  return painted([&](int x, int y, int c) {
    double value = 90 + x + y + 10 * c;
    for (const auto& b : blots)
      if (std::hypot(x - b[0], y - b[1]) < b[2]) value += b[3 + static_cast<size_t>(c)];
    return value;
  });
}

// Light and dark from pixel to pixel, as gravel is.
Pixels rough(uint64_t seed) {
  Random random(seed);
  std::vector<int> light;
  for (int i = 0; i < kPictureEdge * kPictureEdge; ++i) light.push_back(static_cast<int>(random.below(80)));
  return painted([&](int x, int y, int) { return 80 + light[static_cast<size_t>(y * kPictureEdge + x)]; });
}

Pixels noise(uint64_t seed) {
  Random random(seed);
  return painted([&](int, int, int) { return random.below(256); });
}

double psnr(const Pixels& a, const Pixels& b) {
  double squares = 0;
  for (size_t i = 0; i < a.size(); ++i) squares += (a[i] - b[i]) * (a[i] - b[i]);
  return 10 * std::log10(255.0 * 255.0 * static_cast<double>(a.size()) / std::max(squares, 1e-9));
}

TEST(WaveletTest, IsUndoneExactly) {
  Random random(1);
  for (const int edge : {8, 16, 32}) {
    Square square(edge);
    for (int32_t& value : square.values) value = static_cast<int32_t>(random.below(511)) - 255;
    Square again = square;
    analyze(again, 4);
    EXPECT_NE(again.values, square.values);
    synthesize(again, 4);
    EXPECT_EQ(again.values, square.values);
  }
}

// By hand, ISO/IEC 15444-1 (F.6): of 1 2 3 10, high = 2 - (1 + 3) / 2 and 10 - 3 (mirrored), low = 1 + (0 + 0
// + 2) / 4 and 3 + (0 + 7 + 2) / 4, rounded down.
TEST(WaveletTest, IsThe53OfTheStandard) {
  int32_t line[] = {1, 2, 3, 10};
  analyze(line, 4);
  EXPECT_EQ(std::vector<int32_t>(line, line + 4), (std::vector<int32_t>{1, 5, 0, 7}));
}

TEST(PictureCoderTest, TheFirstLayerIsAPictureAndTheSecondSharpensIt) {
  for (uint64_t seed = 0; seed < 20; ++seed) {
    const Pixels rgb = blots(seed);
    const auto layers = encodePicture(rgb);
    ASSERT_EQ(layers.size(), 2u);
    EXPECT_LE(layers[0].size(), PictureSizes{}.first);
    EXPECT_LE(layers[1].size(), PictureSizes{}.second);
    const Pixels small = decodePicture(std::span(layers).first(1)), sharp = decodePicture(layers);
    EXPECT_GT(psnr(small, rgb), 17);
    EXPECT_GT(psnr(sharp, rgb), psnr(small, rgb) + 1) << seed;
    EXPECT_GT(psnr(sharp, rgb), 22);
  }
}

TEST(PictureCoderTest, OneColourIsThatColour) {
  for (const std::array<int, 3>& colour :
       std::vector<std::array<int, 3>>{{0, 0, 0}, {255, 255, 255}, {200, 30, 90}}) {
    const Pixels rgb = painted([&](int, int, int c) { return colour[static_cast<size_t>(c)]; });
    const auto layers = encodePicture(rgb);
    EXPECT_LT(layers[0].size() + layers[1].size(), 60u);
    for (const auto& shown : {decodePicture(layers), decodePicture(std::span(layers).first(1))})
      for (size_t i = 0; i < rgb.size(); ++i) EXPECT_NEAR(shown[i], rgb[i], 6);
  }
}

TEST(PictureCoderTest, NothingIsAboveItsSizeNotEvenNoise) {
  for (uint64_t seed = 0; seed < 10; ++seed) {
    for (const PictureSizes& sizes : {PictureSizes{}, PictureSizes{64, 64}, PictureSizes{540, 540}}) {
      const auto layers = encodePicture(noise(seed), sizes);
      EXPECT_LE(layers[0].size(), sizes.first);
      EXPECT_LE(layers[1].size(), sizes.second);
      EXPECT_EQ(decodePicture(layers).size(), kPictureBytes);
    }
  }
}

TEST(PictureCoderTest, MoreBytesAreNeverMuchWorse) {
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const Pixels rgb = blots(seed);
    EXPECT_GT(psnr(decodePicture(encodePicture(rgb, {500, 500})), rgb),
              psnr(decodePicture(encodePicture(rgb, {80, 120})), rgb) + 1);
  }
}

TEST(PictureCoderTest, AnyBytesAreSomePicture) {
  Random random(9);
  const auto good = encodePicture(blots(3));
  for (int trial = 0; trial < 3000; ++trial) {
    std::vector<Bytes> layers = good;
    for (Bytes& layer : layers) {
      if (trial % 3 == 0) layer.assign(random.below(540), 0);
      for (uint8_t& byte : layer)
        if (trial % 3 == 0 || random.below(20) == 0)
          byte = trial % 2 == 0 ? 0xff : static_cast<uint8_t>(random());
      if (trial % 5 == 0) layer.resize(layer.size() / 2);
    }
    EXPECT_EQ(decodePicture(layers).size(), kPictureBytes);
  }
  const std::vector<Bytes> nothing = {{}, {}, {}, {}};
  EXPECT_EQ(decodePicture(nothing).size(), kPictureBytes);
}

TEST(PictureCoderTest, WrongArgumentsAreRefused) {
  EXPECT_THROW(encodePicture(Pixels(5)), std::invalid_argument);
  EXPECT_THROW(encodePicture(blots(1), {63, 200}), std::invalid_argument);
  EXPECT_THROW(decodePicture({}), std::invalid_argument);
}

mapping::ExamplePicture example(int topic, int number, int observation, const Pixels& rgb) {
  return {world::TopicId{topic}, number, observation, {1, 2, 3}, {5}, rgb};
}

TEST(PictureChangesTest, FirstLayersOfTheMostTypicalComeFirstAndNothingIsSaidTwice) {
  mapping::LocalBelief belief{
      .robot = world::RobotId{4}, .version = {2, 9}, .groups = {}, .topics = {}, .cells = {}};
  belief.examples = {example(0, 0, 5, blots(1)), example(0, 1, 7, blots(2)), example(3, 0, 6, blots(3))};
  PictureChanges changes;
  std::vector<std::array<int32_t, 3>> order;  // topic, number, part
  for (const mapping::Piece& piece : changes.update(belief)) {
    order.push_back({piece.key.index[0], piece.key.index[1], piece.part});
    EXPECT_EQ(piece.version.epoch, 2);
  }
  EXPECT_EQ(order, (std::vector<std::array<int32_t, 3>>{
                       {0, 0, 0}, {3, 0, 0}, {0, 1, 0}, {0, 0, 1}, {3, 0, 1}, {0, 1, 1}}));
  EXPECT_TRUE(changes.update(belief).empty());

  belief.examples[1] = example(0, 1, 11, {});  // no more
  belief.examples[2] = example(3, 0, 12, rough(4));
  const auto changed = changes.update(belief);
  ASSERT_EQ(changed.size(), 3u);
  EXPECT_EQ(changed[0].key.index, (std::array<int32_t, 3>{0, 1, 0}));
  EXPECT_TRUE(std::get<mapping::PicturePart>(changed[0].content).layer.empty());
  EXPECT_EQ(changed[0].version, (world::Version{2, 11}));
  EXPECT_EQ(changed[1].version, (world::Version{2, 12}));
}

TEST(SharperPiecesTest, ShowTheSameExampleSharperWithinTheirSizes) {
  const mapping::ExamplePicture example{.topic = world::TopicId{3},
                                        .number = 1,
                                        .observation = 7,
                                        .cell = {1, 2, 0},
                                        .seen = {5},
                                        .rgb = rough(4)};
  const auto usual = picturePieces(example, world::RobotId{2}, 0);
  const auto sharper = sharperPieces(example, world::RobotId{2}, 0);
  ASSERT_EQ(sharper.size(), 2u);
  std::vector<Bytes> usual_layers, sharper_layers;
  for (const auto& piece : usual) usual_layers.push_back(std::get<mapping::PicturePart>(piece.content).layer);
  for (const auto& piece : sharper) {
    EXPECT_EQ(piece.key.index, (std::array<int32_t, 3>{3, 5, 0}));
    EXPECT_EQ(piece.version, usual[0].version);
    EXPECT_EQ(faultOf(std::get<mapping::PicturePart>(piece.content), piece), "");
    sharper_layers.push_back(std::get<mapping::PicturePart>(piece.content).layer);
  }
  EXPECT_LE(sharper_layers[0].size(), kSharperSizes.first);
  EXPECT_LE(sharper_layers[1].size(), kSharperSizes.second);
  const double before = psnr(example.rgb, decodePicture(usual_layers));
  const double after = psnr(example.rgb, decodePicture(sharper_layers));
  RecordProperty("psnr_db_before", static_cast<int>(before * 100));
  RecordProperty("psnr_db_after", static_cast<int>(after * 100));
  EXPECT_GT(after, before + 3) << before;
  EXPECT_FALSE(isFinest(usual_layers));
  EXPECT_FALSE(isFinest(std::span(usual_layers).first(1)));
  EXPECT_TRUE(isFinest(encodePicture(Pixels(kPictureBytes, 90))));
  mapping::ExamplePicture gone = example;
  gone.rgb.clear();
  EXPECT_TRUE(sharperPieces(gone, world::RobotId{2}, 0).empty());
}

}  // namespace
}  // namespace shoal::wire
