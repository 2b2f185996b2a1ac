// SPDX-License-Identifier: BSD-3-Clause
// Trains the dense vocabulary of profile "best" on pictures in folders and on reefs. rebuild-vocabularies.sh
// says on which.
#include <algorithm>
#include <array>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <iostream>
#include <stdexcept>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "shoal/random.h"
#include "shoal/vision/dense_features.h"
#include "shoal/vision/dense_vocabulary.h"
#include "shoal/vision/k_means.h"
#include "shoal/vision/tools/training_pictures.h"

namespace {

namespace fs = std::filesystem;
using namespace shoal::vision;

constexpr int kLongestSide = 2560;  // pixels of a picture at its largest scale
constexpr int kNumScales = 3;       // each half the one before: photographs are soft at full size
constexpr int kLeastSide = 64;      // pixels; smaller scales are left out
constexpr std::array kClarities{
    1.0, 0.4};  // ground from high above and through water has less colour and contrast
constexpr size_t kPointsOfScale = 500;  // of a picture and clarity, so that every picture has as many votes
constexpr int kReefFrames = 120;        // of one reef
constexpr size_t kPointsOfFrame = 200;

// Training points by kind of feature: points x dimensions.
using TrainingPoints = std::array<std::vector<int16_t>, kNumFeatureKinds>;

// Adds up to `count` points of a picture, drawn at random without repetition.
void describe(const cv::Mat& picture, const ChannelResponses& responses, size_t count,
              TrainingPoints& points) {
  const DenseFeatures features = denseFeatures(picture, responses);
  std::vector<size_t> order(features.numPoints());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  shoal::Random random(points[0].size());
  count = std::min(count, order.size());
  for (size_t i = 0; i < count; ++i) {  // the first steps of Fisher and Yates' shuffle
    std::swap(order[i], order[i + static_cast<size_t>(random.below(order.size() - i))]);
    for (size_t kind = 0; kind < kNumFeatureKinds; ++kind) {
      const auto dimensions = static_cast<ptrdiff_t>(kFeatureKinds[kind].dimensions);
      const auto first = features.values[kind].begin() + static_cast<ptrdiff_t>(order[i]) * dimensions;
      points[kind].insert(points[kind].end(), first, first + dimensions);
    }
  }
}

// The picture as seen through haze or water: every pixel keeps the part `clarity` of its way from the mean
// colour.
cv::Mat throughHaze(const cv::Mat& picture, double clarity) {
  cv::Mat hazy;
  cv::addWeighted(picture, clarity, cv::Mat(picture.size(), picture.type(), cv::mean(picture)), 1.0 - clarity,
                  0.0, hazy);
  return hazy;
}

// What one camera has seen through haze: corrected together, each picture at all scales.
void describeCamera(const std::vector<fs::path>& files, double clarity, TrainingPoints& points) {
  const auto load = [&](const fs::path& file) {
    return throughHaze(loadPicture(file, kLongestSide), clarity);
  };
  PhotometricCorrection correction;
  for (const fs::path& file : files) correction.observe(load(file));
  for (const fs::path& file : files) {
    cv::Mat picture = load(file);
    for (int scale = 0; scale < kNumScales && std::min(picture.cols, picture.rows) >= kLeastSide; ++scale) {
      describe(picture, correction.responses(), kPointsOfScale, points);
      cv::Mat half;
      cv::resize(picture, half, {picture.cols / 2, picture.rows / 2}, 0, 0, cv::INTER_AREA);
      picture = half;
    }
  }
}

void describeReef(const std::string& spec, TrainingPoints& points) {
  const std::vector<cv::Mat> frames = reefFrames(spec, kReefFrames);
  PhotometricCorrection correction;
  for (const cv::Mat& frame : frames) correction.observe(frame);
  for (const cv::Mat& frame : frames) describe(frame, correction.responses(), kPointsOfFrame, points);
}

void describeSource(const std::string& source, TrainingPoints& points) {
  if (source.starts_with("reef:")) {
    describeReef(source, points);
    return;
  }
  for (const double clarity : kClarities) {
    if (source.starts_with("one:")) {
      describeCamera(picturesIn(source.substr(4)), clarity, points);
    } else {
      for (const fs::path& file : picturesIn(source)) describeCamera({file}, clarity, points);
    }
  }
}

DenseVocabulary train(const TrainingPoints& points) {
  std::vector<DenseWordList> lists;
  for (size_t kind = 0; kind < kNumFeatureKinds; ++kind) {
    const FeatureKind& feature = kFeatureKinds[kind];
    const std::string name(feature.name);
    const KMeansResult result = kMeans(points[kind], feature.dimensions,
                                       {.num_words = feature.num_words, .max_rounds = 20, .seed = 1});
    std::cerr << name << ": " << result.rounds << " rounds, mean squared distance "
              << result.mean_squared_distance << "\n";
    lists.push_back({name, feature.dimensions, result.words});
  }
  return DenseVocabulary(std::move(lists));
}

void build(const fs::path& out, const std::vector<std::string>& sources) {
  TrainingPoints points;
  const auto numPoints = [&] { return points[0].size() / static_cast<size_t>(kFeatureKinds[0].dimensions); };
  for (const std::string& source : sources) {
    const size_t before = numPoints();
    describeSource(source, points);
    std::cerr << source << ": " << numPoints() - before << " points\n";
  }
  const DenseVocabulary vocabulary = train(points);
  writeBytes(out, vocabulary.serialize());
  std::cerr << out.string() << ": of " << numPoints() << " points, fingerprint " << std::hex
            << vocabulary.fingerprint() << "\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3 || std::string(argv[1]).starts_with("-")) {
    std::cerr
        << "usage: shoal_build_dense_vocabulary OUT.voc FOLDER|one:FOLDER|reef:STYLE...\n"
           "Trains the dense words on the sources and writes them. Every picture of FOLDER counts as taken\n"
           "by a camera of its own, those of one:FOLDER by one camera, as do the frames of a reef: a "
           "camera's\n"
           "brightness and colour cast are taken out before. Equal sources give equal bytes.\n";
    return 2;
  }
  try {
    build(argv[1], std::vector<std::string>(argv + 2, argv + argc));
  } catch (const std::exception& error) {
    std::cerr << error.what() << "\n";
    return 1;
  }
  return 0;
}
