// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/cells_coder.h"

#include <cstdlib>
#include <numeric>

#include "shoal/wire/context_table.h"
#include "shoal/wire/range_coder.h"

namespace shoal::wire {
namespace {

// Values that a cell's surroundings suggest, best first.
struct Candidates {
  static constexpr size_t kMost = 4;
  std::array<int32_t, kMost> value{}, votes{};
  size_t count = 0;
  int32_t all_votes = 0;
};

Candidates candidatesOf(const std::array<int32_t, kNumNear>& near) {
  std::array<int32_t, kNumNear> value{}, votes{};
  size_t count = 0;
  Candidates best;
  for (size_t k = 0; k < kNumNear; ++k) {
    if (near[k] < 0) continue;
    const int32_t weight = k < kNearColumns.size() ? kNearColumns[k].weight : kBelowWeight;
    best.all_votes += weight;
    size_t i = 0;
    while (i < count && value[i] != near[k]) ++i;
    if (i == count) value[count++] = near[k];
    votes[i] += weight;
  }
  while (best.count < std::min(count, Candidates::kMost)) {  // of equal votes the nearer first
    size_t top = 0;
    for (size_t i = 1; i < count; ++i)
      if (votes[i] > votes[top]) top = i;
    best.value[best.count] = value[top];
    best.votes[best.count++] = votes[top];
    votes[top] = -1;
  }
  return best;
}

// Is a neighbour unknown (0), another (1), or what is asked about (2)?
size_t relation(int32_t near, int32_t asked) { return near < 0 ? 0 : near == asked ? 2 : 1; }

// What the shape of the map says of a cell: things that stand out are labelled otherwise than the ground.
struct Lie {
  static constexpr size_t kStacks = 9, kForms = 6 * 6 * kStacks, kLevels = 64;
  size_t stack, form, level;

  Lie(const CellField::Shape& shape, int32_t z)
      : stack(size_t{shape.above} * 3 + shape.below),
        form((size_t{shape.west} * 6 + shape.south) * kStacks + stack),
        level(static_cast<uint32_t>(z) % kLevels) {}
};

// The questions "is it the best candidate?", "the next?", ... in the light of the surroundings.
class Questions {
 public:
  static constexpr size_t kShares = 16;

  Questions() : shares_(kShares * 4 * 4), mixer_(7, 4 * 4) {
    for (size_t rank = 0; rank < 4; ++rank) {
      for (size_t share = 0; share < kShares; ++share) {
        for (size_t known = 0; known < 4; ++known) {
          const auto one = static_cast<uint16_t>(rank == 0 ? 12000 + share * 3350
                                                           : 6000 + share * (rank == 1 ? 3300 : 3000));
          shares_[(rank * kShares + share) * 4 + known] = {.one = one, .seen = 2};
        }
      }
    }
  }

  template <typename Coder>
  int ask(Coder& coder, const Candidates& candidates, size_t rank, int32_t votes_left,
          const std::array<int32_t, kNumNear>& near, size_t surprises, const Lie& lie, int bit) {
    const int32_t asked = candidates.value[rank];
    const size_t share =
        std::min<size_t>(kShares - 1, static_cast<size_t>(candidates.votes[rank] * 16 / votes_left));
    const size_t known = std::min<size_t>(3, static_cast<size_t>(candidates.all_votes / 30));
    const auto is = [&](size_t k) { return relation(near[k], asked); };
    const size_t nearest = is(0) + 3 * is(1) + 9 * is(2) + 27 * is(3);
    const size_t second = is(4) + 3 * is(5) + 9 * is(6) + 27 * is(18);
    const size_t ring = is(7) + 3 * is(8) + 9 * is(9) + 27 * is(10);
    const size_t beside = is(0) + 3 * is(1);
    const auto label = static_cast<size_t>(std::min(asked, 31));
    const std::array<ContextBit*, 7> contexts = {
        &shares_[(rank * kShares + share) * 4 + known],
        &inner_[(rank * 81 + nearest) * 81 + second],
        &names_[(label * 81 + nearest) * 4 + rank],
        &rings_[(rank * 81 + ring) * 81 + nearest],
        &surprised_[((rank * kShares + share) * 4 + surprises) * 4 + std::min<size_t>(3, candidates.count)],
        &forms_[(label * Lie::kForms + lie.form) * 9 + beside],
        &levels_[(((label * Lie::kLevels + lie.level) * Lie::kStacks + lie.stack) * 3 + is(18)) * 3 + is(0)]};
    return mixer_.code(coder, contexts, rank * 4 + share / 4, bit);
  }

 private:
  std::vector<ContextBit> shares_;
  ContextTable inner_{size_t{4} * 81 * 81}, names_{size_t{32} * 81 * 4}, rings_{size_t{4} * 81 * 81};
  ContextTable surprised_{4 * kShares * 16}, forms_{32 * Lie::kForms * 9};
  ContextTable levels_{32 * Lie::kLevels * Lie::kStacks * 9};
  BitMixer mixer_;
};

// A value that no candidate is: the frequent ones are asked about first, those ruled out not at all.
class NewNames {
 public:
  explicit NewNames(int32_t size) : seen_(static_cast<size_t>(size)), order_(static_cast<size_t>(size)) {
    std::iota(order_.begin(), order_.end(), 0);
  }

  template <typename Coder>
  int32_t code(Coder& coder, const Candidates& ruled_out, int32_t value) {
    const auto out = std::span(ruled_out.value).first(ruled_out.count);
    size_t left = order_.size() - out.size();
    size_t asked = 0;
    for (const int32_t name : order_) {
      if (std::find(out.begin(), out.end(), name) != out.end()) continue;
      if (--left == 0) return name;
      if (coder.bit(hit_[std::min<size_t>(asked++, hit_.size() - 1)], value == name ? 1 : 0) != 0)
        return name;
    }
    return -1;  // every name is ruled out: no Encoder comes here
  }

  void count(int32_t value) {
    const auto at = std::find(order_.begin(), order_.end(), value);
    const int32_t seen = ++seen_[static_cast<size_t>(value)];
    auto place = at;
    while (place != order_.begin() && seen_[static_cast<size_t>(*(place - 1))] < seen) --place;
    std::rotate(place, at, at + 1);
  }

 private:
  std::vector<int32_t> seen_;
  std::vector<int32_t> order_;  // frequent first
  std::array<AdaptiveBit, 24> hit_;
};

// A value that no candidate is, but probably near the best one; without candidates, near the value before.
class NewSteps {
 public:
  template <typename Coder>
  int64_t code(Coder& coder, const Candidates& candidates, int32_t value) {
    const int32_t from = candidates.count > 0 ? candidates.value[0] : last_;
    const int32_t least = candidates.count > 0 ? 1 : 0;  // the best candidate itself is ruled out
    const bool after = coder.bit(after_, value > from ? 1 : 0) != 0;
    const auto distance = static_cast<uint32_t>(std::max(std::abs(value - from) - least, 0));
    const int64_t step = int64_t{distance_.code(coder, distance)} + least;
    return after ? from + step : from - step;
  }

  void count(int32_t value) { last_ = value; }

 private:
  int32_t last_ = 0;
  AdaptiveBit after_;
  SmallNumber distance_;
};

}  // namespace

template <typename Coder>
bool codeIndices(Coder& coder, const CellField& field, int32_t size, Scale scale,
                 std::vector<int32_t>& indices) {
  const std::vector<NearCells>& all_near = field.near();
  indices.resize(all_near.size());
  if (size == 1) {
    std::fill(indices.begin(), indices.end(), 0);
    return true;
  }
  Questions questions;
  NewNames names(size);
  NewSteps steps;
  std::vector<uint8_t> surprise(indices.size());  // not the best candidate
  const std::vector<CellField::Shape> shapes = field.shapes();
  for (size_t i = 0; i < indices.size(); ++i) {
    if (coder.overrun()) return false;
    std::array<int32_t, kNumNear> near{};
    for (size_t k = 0; k < kNumNear; ++k)
      near[k] = all_near[i][k] < 0 ? -1 : indices[static_cast<size_t>(all_near[i][k])];
    const auto surprised = [&](size_t k) {
      return all_near[i][k] < 0 ? size_t{0} : size_t{surprise[static_cast<size_t>(all_near[i][k])]};
    };
    const Candidates candidates = candidatesOf(near);
    int64_t value = indices[i];
    bool known = false;
    int32_t votes_left = candidates.all_votes;
    const size_t surprises = surprised(0) + 2 * surprised(1);
    const Lie lie(shapes[i], field.cells()[i].z);
    for (size_t rank = 0; rank < candidates.count && !known; ++rank) {
      known = questions.ask(coder, candidates, rank, votes_left, near, surprises, lie,
                            value == candidates.value[rank] ? 1 : 0) != 0;
      if (known) value = candidates.value[rank];
      surprise[i] = rank > 0 || !known ? 1 : 0;
      votes_left = std::max(1, votes_left - candidates.votes[rank]);
    }
    if (!known) {
      value = scale == Scale::kNames ? names.code(coder, candidates, static_cast<int32_t>(value))
                                     : steps.code(coder, candidates, static_cast<int32_t>(value));
    }
    if (value < 0 || value >= size) return false;
    indices[i] = static_cast<int32_t>(value);
    if (scale == Scale::kNames) {
      names.count(indices[i]);
    } else {
      steps.count(indices[i]);
    }
  }
  return true;
}

template <typename Coder>
bool codePalette(Coder& coder, int64_t limit, size_t max_size, std::vector<int64_t>& palette) {
  const uint64_t size = codeWide(coder, palette.size());
  if (size == 0 || size > max_size) return false;
  palette.resize(size);
  LongNumber gap;
  int64_t next = 0;  // the least that may come
  for (int64_t& value : palette) {
    if (coder.overrun() || next > limit) return false;
    const uint64_t step = gap.code(coder, static_cast<uint64_t>(value - next));
    if (step > static_cast<uint64_t>(limit - next)) return false;
    value = next + static_cast<int64_t>(step);
    next = value + 1;
  }
  return true;
}

template <typename Coder>
bool codeTimes(Coder& coder, int64_t limit, size_t max_size, std::vector<int64_t>& times) {
  int64_t period = 0;
  for (const int64_t time : times) period = std::gcd(period, time);
  period = std::max<int64_t>(period, 1);
  period = static_cast<int64_t>(codeWide(coder, static_cast<uint64_t>(period)));
  if (period < 1 || period > limit) return false;
  for (int64_t& time : times) time /= period;
  if (!codePalette(coder, limit / period, max_size, times)) return false;
  for (int64_t& time : times) time *= period;
  return true;
}

template bool codeIndices(Encoder&, const CellField&, int32_t, Scale, std::vector<int32_t>&);
template bool codeIndices(Decoder&, const CellField&, int32_t, Scale, std::vector<int32_t>&);
template bool codePalette(Encoder&, int64_t, size_t, std::vector<int64_t>&);
template bool codePalette(Decoder&, int64_t, size_t, std::vector<int64_t>&);
template bool codeTimes(Encoder&, int64_t, size_t, std::vector<int64_t>&);
template bool codeTimes(Decoder&, int64_t, size_t, std::vector<int64_t>&);

}  // namespace shoal::wire
