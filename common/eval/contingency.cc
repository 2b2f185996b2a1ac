// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/contingency.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "shoal/eval/parallel.h"

namespace shoal::eval {
namespace {

constexpr int kTableBits = 16;                // of a place in the table: 65,536 pairs
constexpr size_t kStretch = size_t{1} << 20;  // of cells, counted by one thread

// A pair of ids with its number of cells.
struct Pair {
  int label, truth;
  int64_t cells;
};

// Numbers from `lowest` on, 2^bits of them.
struct Range {
  uint32_t lowest = 0;
  int bits = 0;

  // Takes in all of `ids` as well; doubles at least, so that ids which come in order do not make it grow
  // often.
  void growTo(std::span<const int> ids, bool is_new) {
    const auto [least, greatest] = std::minmax_element(ids.begin(), ids.end());
    int64_t low = *least, high = *greatest;
    const int64_t was = static_cast<int>(lowest);
    if (!is_new) {
      low = std::min(low, was);
      high = std::max(high, was + (int64_t{1} << bits) - 1);
    }
    while (int64_t{1} << bits < high - low + 1) ++bits;
    lowest = static_cast<uint32_t>(!is_new && low < was ? high - (int64_t{1} << bits) + 1 : low);
  }
};

// Counts in a table with a place for every pair of ids seen so far, in one pass over memory; gives up
// (nothing) when that table grows too large. Pairs may come more than once.
std::optional<std::vector<Pair>> countInTable(std::span<const int> label, std::span<const int> truth) {
  // Places are worked out a block at a time, in vectors. Neighbours are mostly alike: tables in turn keep an
  // addition from waiting for the last one.
  constexpr size_t kTables = 8, kBlock = 1024;
  Range labels, truths;
  std::vector<uint32_t> tables;  // place by place
  std::vector<Pair> pairs;
  const auto takeOut = [&] {
    for (size_t place = 0; place < tables.size() / kTables; ++place) {
      int64_t cells = 0;
      for (size_t table = 0; table < kTables; ++table) cells += tables[place * kTables + table];
      if (cells == 0) continue;
      const auto l = static_cast<uint32_t>(place >> truths.bits);
      const auto t = static_cast<uint32_t>(place) & ((1u << truths.bits) - 1);
      pairs.push_back({static_cast<int>(labels.lowest + l), static_cast<int>(truths.lowest + t), cells});
    }
  };
  std::array<uint32_t, kBlock> places;
  for (size_t done = 0; done < label.size(); done += kBlock) {
    const std::span<const int> l = label.subspan(done, std::min(kBlock, label.size() - done));
    const std::span<const int> t = truth.subspan(done, l.size());
    const auto fillPlaces = [&] {  // tells whether the table has them all
      uint32_t label_bits = 0, truth_bits = 0;
      for (size_t n = 0; n < l.size(); ++n) {
        const uint32_t from_label = static_cast<uint32_t>(l[n]) - labels.lowest;
        const uint32_t from_truth = static_cast<uint32_t>(t[n]) - truths.lowest;
        label_bits |= from_label;
        truth_bits |= from_truth;
        places[n] = (from_label << truths.bits) + from_truth;
      }
      return label_bits >> labels.bits == 0 && truth_bits >> truths.bits == 0;
    };
    if (done == 0 || !fillPlaces()) {
      takeOut();
      labels.growTo(l, done == 0);
      truths.growTo(t, done == 0);
      if (labels.bits + truths.bits > kTableBits) return std::nullopt;
      tables.assign(kTables << (labels.bits + truths.bits), 0);
      fillPlaces();
    }
    uint32_t* const counts = tables.data();
    size_t n = 0;
    for (; n + kTables <= l.size(); n += kTables) {
      for (size_t table = 0; table < kTables; ++table) ++counts[places[n + table] * kTables + table];
    }
    for (; n < l.size(); ++n) ++counts[places[n] * kTables];
  }
  takeOut();
  return pairs;
}

std::vector<Pair> oneByOne(std::span<const int> label, std::span<const int> truth) {
  std::vector<Pair> pairs(label.size());
  for (size_t n = 0; n < label.size(); ++n) pairs[n] = {label[n], truth[n], 1};
  return pairs;
}

// A stretch of the cells after the other, on all cores.
std::vector<Pair> countAll(std::span<const int> label, std::span<const int> truth) {
  std::vector<std::vector<Pair>> counted((label.size() + kStretch - 1) / kStretch);
  forEachInParallel(static_cast<int>(counted.size()), [&](int i) {
    const size_t from = static_cast<size_t>(i) * kStretch, cells = std::min(kStretch, label.size() - from);
    const auto l = label.subspan(from, cells), t = truth.subspan(from, cells);
    std::optional<std::vector<Pair>> pairs = countInTable(l, t);
    counted[static_cast<size_t>(i)] = pairs ? *std::move(pairs) : oneByOne(l, t);
  });
  std::vector<Pair> all;
  for (const std::vector<Pair>& pairs : counted) all.insert(all.end(), pairs.begin(), pairs.end());
  return all;
}

std::vector<Pair> merged(std::vector<Pair> pairs) {
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
    return std::pair(a.label, a.truth) < std::pair(b.label, b.truth);
  });
  std::vector<Pair> result;
  for (const Pair& pair : pairs) {
    if (result.empty() || result.back().label != pair.label || result.back().truth != pair.truth) {
      result.push_back({pair.label, pair.truth, 0});
    }
    result.back().cells += pair.cells;
  }
  return result;
}

std::vector<int> distinct(std::vector<int> ids) {
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  return ids;
}

int placeAmong(const std::vector<int>& ascending, int id) {
  return static_cast<int>(std::lower_bound(ascending.begin(), ascending.end(), id) - ascending.begin());
}

}  // namespace

Contingency contingency(std::span<const int> label, std::span<const int> truth) {
  if (label.size() != truth.size()) {
    throw std::invalid_argument("two labellings of the same cells must be equally long, got " +
                                std::to_string(label.size()) + " and " + std::to_string(truth.size()));
  }
  const std::vector<Pair> pairs = merged(countAll(label, truth));

  Contingency result;
  result.num_cells = static_cast<int64_t>(label.size());
  std::vector<int> label_ids, truth_ids;
  for (const Pair& pair : pairs) {
    label_ids.push_back(pair.label);
    truth_ids.push_back(pair.truth);
  }
  result.label_ids = distinct(std::move(label_ids));
  result.truth_ids = distinct(std::move(truth_ids));
  result.label_cells.assign(result.label_ids.size(), 0);
  result.truth_cells.assign(result.truth_ids.size(), 0);
  for (const Pair& pair : pairs) {
    const int l = placeAmong(result.label_ids, pair.label), t = placeAmong(result.truth_ids, pair.truth);
    result.counts.push_back({l, t, pair.cells});
    result.label_cells[static_cast<size_t>(l)] += pair.cells;
    result.truth_cells[static_cast<size_t>(t)] += pair.cells;
  }
  return result;
}

}  // namespace shoal::eval
