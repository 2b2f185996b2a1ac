// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/descriptors.h"

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>

namespace shoal::matching {
namespace {

constexpr int64_t kMaxTotal = int64_t{1} << 62;  // products of two totals fit 128 bits

void check(const Descriptor& topic, int32_t vocabulary_size, size_t robot, size_t number) {
  const auto refuse = [&](const std::string& why) {
    throw std::invalid_argument("robot " + std::to_string(robot) + ", topic " + std::to_string(number) + why);
  };
  int32_t previous = -1;
  int64_t total = 0;
  for (const Descriptor::Entry& e : topic.entries) {
    if (e.word < 0 || e.word >= vocabulary_size) {
      refuse(": word " + std::to_string(e.word) + " is not in the vocabulary of " +
             std::to_string(vocabulary_size));
    }
    if (e.word <= previous) refuse(": word " + std::to_string(e.word) + " does not ascend");
    if (e.weight <= 0) {
      refuse(": word " + std::to_string(e.word) + " has weight " + std::to_string(e.weight) +
             ", above 0 would be right");
    }
    if (e.weight > kMaxTotal - total) refuse(": the weights sum to more than 2^62");
    total += e.weight;
    previous = e.word;
  }
}

}  // namespace

void check(const DescriptorSet& topics) {
  if (topics.vocabulary_size < 0) {
    throw std::invalid_argument("a vocabulary cannot have " + std::to_string(topics.vocabulary_size) +
                                " words");
  }
  const std::vector<int32_t>& first = topics.group_first;
  if (!first.empty() &&
      (first.front() != 0 || first.back() >= topics.vocabulary_size ||
       std::adjacent_find(first.begin(), first.end(), std::greater_equal<>()) != first.end())) {
    throw std::invalid_argument("word groups must ascend from word 0 within the vocabulary of " +
                                std::to_string(topics.vocabulary_size));
  }
  for (size_t r = 0; r < topics.robots.size(); ++r) {
    for (size_t t = 0; t < topics.robots[r].size(); ++t) {
      check(topics.robots[r][t], topics.vocabulary_size, r, t);
    }
  }
}

}  // namespace shoal::matching
