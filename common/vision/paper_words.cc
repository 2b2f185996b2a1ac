// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/paper_words.h"

#include <array>
#include <stdexcept>
#include <string>

#include "shoal/random.h"
#include "shoal/vision/color_words.h"
#include "shoal/vision/equalized_channels.h"
#include "shoal/vision/orb_descriptors.h"
#include "shoal/vision/placement.h"

namespace shoal::vision {
namespace {

constexpr int kMinSide = 32;  // pixels

// Grows whenever the same picture and vocabulary would give other words.
constexpr uint64_t kPaperWordsVersion = 1;

enum Group : size_t { kOrbL, kOrbA, kOrbB, kHue, kIntensity };

std::vector<world::WordGroup> paperGroups(int32_t orb_words) {
  std::vector<world::WordGroup> groups;
  int32_t first = 0;
  const auto append = [&](const char* name, int32_t size) {
    groups.push_back({name, first, size});
    first += size;
  };
  append("orb_l", orb_words);
  append("orb_a", orb_words);
  append("orb_b", orb_words);
  append("hue", kNumHues);
  append("intensity", kNumIntensities);
  return groups;
}

uint64_t paperFingerprint(const Vocabulary& vocabulary) {
  uint64_t hash = hashCombine(vocabulary.fingerprint(), kPaperWordsVersion);
  for (const int parameter : {kClaheClipLimit, kClaheTiles, kOrbKeyPoints, kThumbnailColumns}) {
    hash = hashCombine(hash, static_cast<uint64_t>(parameter));
  }
  return hash;
}

}  // namespace

PaperWords::PaperWords(const Vocabulary& vocabulary)
    : search_(vocabulary.words()),
      groups_(paperGroups(vocabulary.size())),
      fingerprint_(paperFingerprint(vocabulary)) {}

std::vector<PixelWord> PaperWords::words(const cv::Mat& bgr) const {
  const EqualizedChannels picture = equalize(bgr);
  std::vector<PixelWord> words = colorWords(picture.bgr, groups_[kHue].first, groups_[kIntensity].first);
  for (const Group channel : {kOrbL, kOrbA, kOrbB}) {
    const std::vector<OrbDescriptor> found = orbDescriptors(picture.lab[channel - kOrbL]);
    std::vector<BinaryWord> descriptors;
    descriptors.reserve(found.size());
    for (const OrbDescriptor& descriptor : found) descriptors.push_back(descriptor.bits);
    const std::vector<int32_t> nearest = search_.nearest(descriptors);
    for (size_t i = 0; i < found.size(); ++i) {
      words.push_back({found[i].u, found[i].v, groups_[channel].first + nearest[i]});
    }
  }
  return words;
}

world::WordsInCells PaperWords::extract(const world::Observation& observation, const world::Grid& grid) {
  checkObservation(observation);
  if (observation.color.cols < kMinSide || observation.color.rows < kMinSide) {
    throw std::invalid_argument("images must be at least 32x32 pixels, got " +
                                std::to_string(observation.color.cols) + "x" +
                                std::to_string(observation.color.rows));
  }
  return placeWords(words(observation.color), observation, grid);
}

}  // namespace shoal::vision
