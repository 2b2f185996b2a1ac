// SPDX-License-Identifier: BSD-3-Clause
// What an image of profile "paper" costs, stage by stage, and exact word search against cv::BFMatcher. Times
// are of one thread; only ratios within one run are comparable.
#include <algorithm>
#include <cstring>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/core.hpp>
#include <opencv2/features2d.hpp>

#include "pictures.h"
#include "shoal/vision/color_words.h"
#include "shoal/vision/equalized_channels.h"
#include "shoal/vision/orb_descriptors.h"
#include "shoal/vision/paper_words.h"
#include "shoal/vision/placement.h"
#include "shoal/vision/shipped_vocabulary.h"

namespace shoal::vision {
namespace {

constexpr int kNumDescriptors = 1000;

cv::Mat picture() { return rectangles({320, 240}, 1); }

// The words of the shipped vocabulary with 60 bits flipped: as far from their word as real descriptors are.
std::vector<BinaryWord> descriptors() {
  const auto words = Vocabulary::parse(shippedOrbVocabulary()).words();
  Random random(1);
  std::vector<BinaryWord> result;
  for (int i = 0; i < kNumDescriptors; ++i) {
    BinaryWord descriptor = words[random.below(words.size())];
    for (int flip = 0; flip < 60; ++flip) descriptor[random.below(4)] ^= uint64_t{1} << random.below(64);
    result.push_back(descriptor);
  }
  return result;
}

cv::Mat toMat(const std::vector<BinaryWord>& words) {
  cv::Mat bytes(static_cast<int>(words.size()), 32, CV_8U);
  std::memcpy(bytes.data, words.data(), words.size() * kBinaryWordBytes);
  return bytes;
}

void wordSearch(benchmark::State& state) {
  const auto path = static_cast<SearchPath>(state.range(0));
  const auto paths = availableSearchPaths();
  if (std::find(paths.begin(), paths.end(), path) == paths.end()) {
    state.SkipWithError("not on this processor");
    return;
  }
  const WordSearch search(Vocabulary::parse(shippedOrbVocabulary()).words(), path);
  const auto queries = descriptors();
  for (auto _ : state) benchmark::DoNotOptimize(search.nearest(queries));
}
BENCHMARK(wordSearch)->ArgName("path")->DenseRange(0, 2)->Unit(benchmark::kMillisecond);

void openCvMatcher(benchmark::State& state) {
  const cv::Mat words = toMat(Vocabulary::parse(shippedOrbVocabulary()).words());
  const cv::Mat queries = toMat(descriptors());
  std::vector<cv::DMatch> matches;
  for (auto _ : state) cv::BFMatcher(cv::NORM_HAMMING).match(queries, words, matches);
}
BENCHMARK(openCvMatcher)->Unit(benchmark::kMillisecond);

void equalizeStage(benchmark::State& state) {
  const cv::Mat bgr = picture();
  for (auto _ : state) benchmark::DoNotOptimize(equalize(bgr));
}
BENCHMARK(equalizeStage)->Unit(benchmark::kMillisecond);

void orbStage(benchmark::State& state) {
  const auto channels = equalize(picture()).lab;
  size_t found = 0;
  for (auto _ : state) {
    found = 0;
    for (const cv::Mat& channel : channels) found += orbDescriptors(channel).size();
  }
  state.counters["words"] = static_cast<double>(found);
}
BENCHMARK(orbStage)->Unit(benchmark::kMillisecond);

void searchStage(benchmark::State& state) {
  const WordSearch search(Vocabulary::parse(shippedOrbVocabulary()).words());
  std::vector<BinaryWord> queries;
  for (const cv::Mat& channel : equalize(picture()).lab) {
    for (const auto& descriptor : orbDescriptors(channel)) queries.push_back(descriptor.bits);
  }
  for (auto _ : state) benchmark::DoNotOptimize(search.nearest(queries));
  state.counters["words"] = static_cast<double>(queries.size());
}
BENCHMARK(searchStage)->Unit(benchmark::kMillisecond);

void colorStage(benchmark::State& state) {
  const cv::Mat bgr = equalize(picture()).bgr;
  for (auto _ : state) benchmark::DoNotOptimize(colorWords(bgr, 15000, 15180));
}
BENCHMARK(colorStage)->Unit(benchmark::kMillisecond);

void placementStage(benchmark::State& state) {
  const auto observation = seenFromAbove(picture(), 4.0);
  auto words = colorWords(observation.color, 15000, 15180);
  for (int32_t i = 0; i < 2500; ++i) words.push_back({(i * 37) % 320, (i * 53) % 240, i});
  const world::Grid grid(0.8);
  for (auto _ : state) benchmark::DoNotOptimize(placeWords(words, observation, grid));
}
BENCHMARK(placementStage)->Unit(benchmark::kMillisecond);

void wholeExtraction(benchmark::State& state) {
  const auto extractor = makeWordExtractor("paper");
  const auto observation = seenFromAbove(picture(), 4.0);
  const world::Grid grid(0.8);
  for (auto _ : state) benchmark::DoNotOptimize(extractor->extract(observation, grid));
}
BENCHMARK(wholeExtraction)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace shoal::vision

int main(int argc, char** argv) {
  cv::setNumThreads(1);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
