// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/label_counts.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "shoal/demand.h"
#include "shoal/topics/fixed_log.h"

namespace shoal::topics {
namespace {

constexpr int32_t kSummedTogether = 4;    // labels summed together; a fixed count lets any compiler vectorise
constexpr int64_t kParts = 256;           // counts and priors are scaled by this, to be integers
constexpr int64_t kSmallCount = 1 << 12;  // logarithms of counts below are looked up

std::vector<world::WordGroup> checked(std::vector<world::WordGroup> groups, int32_t num_labels) {
  int64_t end = 0;
  for (const world::WordGroup& group : groups) {
    if (group.first != end || group.size < 1) {
      throw std::invalid_argument("word groups must tile the vocabulary from 0 on; \"" + group.name +
                                  "\" does not");
    }
    end += group.size;
  }
  if (end < 1 || end * (num_labels + kSummedTogether) > int64_t{1} << 31) {
    throw std::invalid_argument(
        "the vocabulary must have at least 1 word and times max_topics at most 2^31, got " +
        std::to_string(end));
  }
  return groups;
}

}  // namespace

LabelCounts::LabelCounts(std::vector<world::WordGroup> groups, int32_t num_labels, double beta)
    : groups_(checked(std::move(groups), num_labels)),
      stride_((num_labels + kSummedTogether - 1) / kSummedTogether * kSummedTogether),
      prior_(std::max(int64_t{1}, static_cast<int64_t>(std::floor(beta * kParts + 0.5)))) {
  for (int64_t n = 0; n < kSmallCount; ++n) {
    log_of_.push_back(fixedLog2(static_cast<uint64_t>(kParts * n + prior_)));
  }
  counts_.resize(at(vocabularySize(), 0));
  logs_.assign(counts_.size(), log_of_[0]);
  group_counts_.resize(at(static_cast<int32_t>(groups_.size()), 0));
  for (const world::WordGroup& group : groups_) {
    group_logs_.insert(group_logs_.end(), static_cast<size_t>(stride_), logOf(0, group.size * prior_));
  }
}

void LabelCounts::logLikelihoods(std::span<const world::WordCount> words, int32_t own,
                                 std::span<int64_t> scores) const {
  SHOAL_DEMAND(std::ssize(scores) == stride_);
  std::ranges::fill(scores, 0);
  int64_t own_score = 0;
  auto word = words.begin();
  for (size_t g = 0; g < groups_.size() && word != words.end(); ++g) {
    const int32_t end = groups_[g].first + groups_[g].size;
    int64_t total = 0;
    for (; word != words.end() && word->word < end; ++word) {
      const auto count = static_cast<uint32_t>(word->count);
      const uint32_t* __restrict row = logs_.data() + at(word->word, 0);
      int64_t* __restrict sum = scores.data();
      for (int32_t first = 0; first < stride_; first += kSummedTogether) {
        for (int32_t k = first; k < first + kSummedTogether; ++k)
          sum[k] += static_cast<int64_t>(uint64_t{count} * uint64_t{row[k]});
      }
      total += word->count;
      if (own >= 0) {
        own_score += int64_t{word->count} * logOf(counts_[at(word->word, own)] - word->count, prior_);
      }
    }
    const auto row = at(static_cast<int32_t>(g), 0);
    for (size_t k = 0; k < scores.size(); ++k) scores[k] -= total * group_logs_[row + k];
    if (own >= 0 && total > 0) {
      const int64_t others = group_counts_[row + static_cast<size_t>(own)] - total;
      own_score -= total * logOf(others, groups_[g].size * prior_);
    }
  }
  if (own >= 0) scores[static_cast<size_t>(own)] = own_score;
}

std::span<const int32_t> LabelCounts::wordCounts(int32_t word) const {
  return std::span(counts_).subspan(at(word, 0), static_cast<size_t>(stride_));
}

void LabelCounts::change(std::span<const world::WordCount> words, int32_t label, int32_t sign) {
  auto word = words.begin();
  for (size_t g = 0; g < groups_.size() && word != words.end(); ++g) {
    const int32_t end = groups_[g].first + groups_[g].size;
    int64_t total = 0;
    for (; word != words.end() && word->word < end; ++word) {
      const size_t i = at(word->word, label);
      counts_[i] += sign * word->count;
      SHOAL_DEMAND(counts_[i] >= 0);
      logs_[i] = logOf(counts_[i], prior_);
      total += word->count;
    }
    const size_t i = at(static_cast<int32_t>(g), label);
    group_counts_[i] += sign * total;
    group_logs_[i] = logOf(group_counts_[i], groups_[g].size * prior_);
  }
}

// log2 of (count + prior), up to a constant that is the same for all: log2(256).
uint32_t LabelCounts::logOf(int64_t count, int64_t prior) const {
  if (prior == prior_ && count < kSmallCount) return log_of_[static_cast<size_t>(count)];
  return fixedLog2(static_cast<uint64_t>(kParts * count + prior));
}

}  // namespace shoal::topics
