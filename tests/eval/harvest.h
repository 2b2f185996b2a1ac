// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <zlib.h>

#include <algorithm>

#include <cstdint>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

#include "shoal/eval/topic_tally.h"
#include "shoal/matching/descriptors.h"

namespace shoal::eval {

/// What a team had learned at a stage of its mission over a built-in reef, and the truth about it.
struct HarvestedMission {
  std::string world;
  int robots = 0;
  int part = 0;  ///< how much of the mission was over, per cent
  matching::DescriptorSet descriptors;
  TeamTally tally;  ///< one topic a vertex of the descriptors, in their order
};

/// The numbers of a harvest (pack_harvest.py), one after the other.
class HarvestNumbers {
 public:
  explicit HarvestNumbers(const std::string& path) {
    std::ifstream file(path, std::ios::binary);
    const std::string packed{std::istreambuf_iterator<char>(file), {}};
    bytes_.resize(8 << 20);
    uLongf size = bytes_.size();
    if (uncompress(bytes_.data(), &size, reinterpret_cast<const Bytef*>(packed.data()), packed.size()) !=
        Z_OK)
      throw std::runtime_error(path + " is no harvest");
    bytes_.resize(size);
  }
  int64_t next() {
    int64_t n = 0;
    for (int shift = 0;; shift += 7) {
      const uint8_t byte = bytes_.at(at_++);
      n |= int64_t{byte & 127} << shift;
      if (byte < 128) return n;
    }
  }
  int32_t next32() { return static_cast<int32_t>(next()); }
  bool isAtEnd() const { return at_ == bytes_.size(); }

 private:
  std::vector<uint8_t> bytes_;
  size_t at_ = 0;
};

/// @throws std::exception for a file that is not what pack_harvest.py writes.
inline std::vector<HarvestedMission> readHarvest(const std::string& path) {
  HarvestNumbers from(path);
  std::vector<HarvestedMission> missions(static_cast<size_t>(from.next()));
  for (HarvestedMission& m : missions) {
    for (int64_t n = from.next(); n > 0; --n) m.world += static_cast<char>(from.next());
    m.robots = from.next32();
    m.part = from.next32();
    m.descriptors.vocabulary_size = from.next32();
    for (int64_t n = from.next(); n > 0; --n) m.descriptors.group_first.push_back(from.next32());
    m.descriptors.robots.resize(static_cast<size_t>(m.robots));
    for (int64_t n = from.next(); n > 0; --n) {
      TopicTally& topic = m.tally.topics.emplace_back();
      topic.robot = world::RobotId{from.next32()};
      topic.topic = world::TopicId{from.next32()};
      topic.cells = from.next();
      for (int64_t k = from.next(); k > 0; --k) topic.cells_of_class.push_back(from.next());
      m.tally.num_classes = std::max(m.tally.num_classes, static_cast<int>(topic.cells_of_class.size()));
      m.descriptors.robots.at(static_cast<size_t>(number(topic.robot)))
          .push_back({number(topic.topic), std::vector<matching::Descriptor::Entry>(from.next())});
    }
  }
  const auto eachTopic = [&missions](auto visit) {
    for (HarvestedMission& m : missions)
      for (auto& robot : m.descriptors.robots)
        for (matching::Descriptor& topic : robot) visit(topic);
  };
  eachTopic([&from](matching::Descriptor& topic) {
    int32_t word = -1;
    for (auto& e : topic.entries) e.word = word += from.next32() + 1;
  });
  eachTopic([&from](matching::Descriptor& topic) {
    for (auto& e : topic.entries) e.weight = from.next();
  });
  if (!from.isAtEnd()) throw std::runtime_error(path + " is longer than its missions");
  return missions;
}

}  // namespace shoal::eval
