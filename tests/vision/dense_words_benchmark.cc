// SPDX-License-Identifier: BSD-3-Clause
// What an image of 320 x 240 of profile "best" costs, stage by stage. Times are of one thread; only ratios
// within one run are comparable: wholeExtraction is the same of profile "paper".
#include <algorithm>

#include <benchmark/benchmark.h>

#include "pictures.h"
#include "shoal/vision/dense_features.h"
#include "shoal/vision/dense_search.h"
#include "shoal/vision/dense_words.h"
#include "shoal/vision/shipped_vocabulary.h"

namespace shoal::vision {
namespace {

cv::Mat picture() { return rectangles({320, 240}, 1); }

void correctionStage(benchmark::State& state) {
  const cv::Mat bgr = picture();
  PhotometricCorrection correction;
  for (auto _ : state) {
    correction.observe(bgr);
    benchmark::DoNotOptimize(correction.responses());
  }
}
BENCHMARK(correctionStage)->Unit(benchmark::kMillisecond);

void featureStage(benchmark::State& state) {
  const cv::Mat bgr = picture();
  const ChannelResponses responses = PhotometricCorrection().responses();
  for (auto _ : state) benchmark::DoNotOptimize(denseFeatures(bgr, responses));
}
BENCHMARK(featureStage)->Unit(benchmark::kMillisecond);

// The words of all seven kinds at 1200 points.
void denseSearchStage(benchmark::State& state) {
  const auto path = static_cast<DenseSearchPath>(state.range(0));
  const auto paths = availableDenseSearchPaths();
  if (std::find(paths.begin(), paths.end(), path) == paths.end()) {
    state.SkipWithError("not on this processor");
    return;
  }
  std::vector<DenseSearch> searches;
  const DenseVocabulary vocabulary = DenseVocabulary::parse(shippedDenseVocabulary());
  for (const DenseWordList& list : vocabulary.lists()) searches.emplace_back(list, path);
  const DenseFeatures features = denseFeatures(picture(), PhotometricCorrection().responses());
  for (auto _ : state) {
    for (size_t kind = 0; kind < searches.size(); ++kind) {
      benchmark::DoNotOptimize(searches[kind].nearest(features.values[kind]));
    }
  }
}
BENCHMARK(denseSearchStage)->ArgName("path")->DenseRange(0, 1)->Unit(benchmark::kMillisecond);

void wholeDenseExtraction(benchmark::State& state) {
  const auto extractor = makeWordExtractor("best");
  const auto observation = seenFromAbove(picture(), 4.0);
  const world::Grid grid(0.8);
  for (auto _ : state) benchmark::DoNotOptimize(extractor->extract(observation, grid));
}
BENCHMARK(wholeDenseExtraction)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace shoal::vision
