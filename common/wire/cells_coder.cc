// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/cells_coder.h"

#include <bit>
#include <limits>
#include <numeric>

namespace shoal::wire {
namespace {

constexpr int kEdge = Occupancy::kEdge;

// The bounds of what is occupied; of an empty brick, the first cell.
struct Box {
  int x0 = 0, x1 = 0, y0 = 0, y1 = 0, z0 = 0, z1 = 0;
};

Box boundsOf(const Occupancy& occupancy) {
  Box box{kEdge, -1, kEdge, -1, kEdge, -1};
  for (int x = 0; x < kEdge; ++x) {
    for (int y = 0; y < kEdge; ++y) {
      const uint16_t column = occupancy.column(x, y);
      if (column == 0) continue;
      box.x0 = std::min(box.x0, x);
      box.x1 = std::max(box.x1, x);
      box.y0 = std::min(box.y0, y);
      box.y1 = std::max(box.y1, y);
      box.z0 = std::min(box.z0, std::countr_zero(column));
      box.z1 = std::max(box.z1, static_cast<int>(std::bit_width(column)) - 1);
    }
  }
  return box.x1 < 0 ? Box{} : box;
}

// Starting beliefs, P(0) x 65536 worth a few observations: a brick is too small to learn them from scratch.
constexpr AdaptiveBit kSurelyOne{2000, 6};
constexpr AdaptiveBit kProbablyOne{16000, 2};
constexpr AdaptiveBit kEven{32768, 0};
constexpr AdaptiveBit kProbablyZero{49000, 2};
constexpr AdaptiveBit kSurelyZero{63500, 6};

}  // namespace

int Occupancy::numCells() const {
  return std::accumulate(columns_.begin(), columns_.end(), 0,
                         [](int sum, uint16_t column) { return sum + std::popcount(column); });
}

std::vector<world::CellIndex> Occupancy::cells(const std::array<int32_t, 3>& brick) const {
  std::vector<world::CellIndex> cells;
  for (int x = 0; x < kEdge; ++x)
    for (int y = 0; y < kEdge; ++y)
      for (int z = 0; z < kEdge; ++z)
        if (at(x, y, z)) cells.push_back({brick[0] * kEdge + x, brick[1] * kEdge + y, brick[2] * kEdge + z});
  return cells;
}

template <typename Coder>
Occupancy codeOccupancy(Coder& coder, const Occupancy& occupancy) {
  Box box = boundsOf(occupancy);
  for (int* bound : {&box.x0, &box.x1, &box.y0, &box.y1, &box.z0, &box.z1}) {
    *bound = static_cast<int>(coder.direct(static_cast<uint64_t>(*bound), 4));
  }
  // Context of a cell: occupied at (x-1,y), (x,y-1), (x-1,y-1) of its height, at the first two one higher,
  // and whether its own column has a cell already. Outside the box, the columns at its edge go on.
  std::vector<AdaptiveBit> models(64);
  for (size_t context = 0; context < models.size(); ++context) {
    const int alike = std::popcount(context & 7);
    models[context] = alike == 3   ? kSurelyOne
                      : alike == 2 ? kProbablyOne
                      : alike == 1 ? kEven
                                   : kProbablyZero;
    if (alike == 0 && (context & 32) != 0) models[context] = kSurelyZero;
  }
  Occupancy result;
  for (int x = box.x0; x <= box.x1; ++x) {
    for (int y = box.y0; y <= box.y1; ++y) {
      bool has_cell = false;
      for (int z = box.z0; z <= box.z1; ++z) {
        const auto west = [&](int dy, int dz) { return result.at(x - 1, y + dy, z + dz); };
        const auto south = [&](int dz) { return result.at(x, y - 1, z + dz); };
        const bool flat_start = x == box.x0 && y == box.y0 && box.z0 == box.z1;
        const bool w = x > box.x0 ? west(0, 0) : flat_start || south(0);
        const bool s = y > box.y0 ? south(0) : w;
        const bool sw = x > box.x0 && y > box.y0 ? west(-1, 0) : s;
        const bool w_up = x > box.x0 ? west(0, 1) : south(1);
        const bool s_up = y > box.y0 ? south(1) : w_up;
        const unsigned context = (w ? 1u : 0u) | (s ? 2u : 0u) | (sw ? 4u : 0u) | (w_up ? 8u : 0u) |
                                 (s_up ? 16u : 0u) | (has_cell ? 32u : 0u);
        if (coder.bit(models[context], occupancy.at(x, y, z) ? 1 : 0) != 0) {
          result.set(x, y, z);
          has_cell = true;
        }
      }
    }
  }
  return result;
}

std::vector<std::array<int16_t, 4>> neighboursOf(const Occupancy& occupancy) {
  std::vector<std::array<int16_t, 4>> all;
  std::array<int16_t, kEdge * kEdge> start{};  // position of each column's lowest cell
  const auto nearest = [&](int x, int y, int z) -> int16_t {
    if (x < 0 || y < 0 || y >= kEdge || occupancy.column(x, y) == 0) return -1;
    const uint16_t column = occupancy.column(x, y);
    for (int distance = 0;; ++distance) {  // the column is not empty: ends
      for (const int height : {z - distance, z + distance}) {
        if (!occupancy.at(x, y, height)) continue;
        const int lower = std::popcount(static_cast<uint16_t>(column & ((1u << height) - 1)));
        return static_cast<int16_t>(start[static_cast<size_t>(x * kEdge + y)] + lower);
      }
    }
  };
  for (int x = 0; x < kEdge; ++x) {
    for (int y = 0; y < kEdge; ++y) {
      start[static_cast<size_t>(x * kEdge + y)] = static_cast<int16_t>(all.size());
      for (int z = 0; z < kEdge; ++z) {
        if (!occupancy.at(x, y, z)) continue;
        const auto below =
            static_cast<int16_t>(occupancy.at(x, y, z - 1) ? static_cast<int>(all.size()) - 1 : -1);
        std::array<int16_t, 4> found{-1, -1, -1, -1};
        size_t count = 0;
        for (const int16_t candidate : {below, nearest(x, y - 1, z), nearest(x - 1, y, z),
                                        nearest(x - 1, y - 1, z), nearest(x - 1, y + 1, z)}) {
          if (candidate >= 0 && count < found.size()) found[count++] = candidate;
        }
        for (; count < found.size(); ++count) found[count] = found[0];
        all.push_back(found);
      }
    }
  }
  return all;
}

template <typename Coder>
bool codeIndices(Coder& coder, std::span<const std::array<int16_t, 4>> neighbours, int32_t size, Scale scale,
                 std::vector<int32_t>& indices) {
  indices.resize(neighbours.size());
  if (size == 1) {
    std::fill(indices.begin(), indices.end(), 0);
    return true;
  }
  // "Is it the first, second, ... of the neighbours' values?", in the light of which of them agree.
  std::array<std::array<AdaptiveBit, 4>, 64> hit;
  hit.fill({kProbablyOne, kEven, kEven, kEven});
  hit[63] = {kSurelyOne, kEven, kEven, kEven};
  BitTree names(static_cast<int>(std::bit_width(static_cast<uint32_t>(size - 1))));
  SmallNumber distance;
  AdaptiveBit later;
  for (size_t i = 0; i < neighbours.size(); ++i) {
    if (coder.overrun()) return false;
    int32_t value = indices[i];
    bool known = false;
    std::array<int32_t, 4> near{};
    const bool alone = neighbours[i][0] < 0;
    if (!alone) {
      for (size_t k = 0; k < 4; ++k) near[k] = indices[static_cast<size_t>(neighbours[i][k])];
      const auto same = [&](size_t a, size_t b) { return near[a] == near[b] ? 1u : 0u; };
      const unsigned pattern = same(0, 1) | same(0, 2) << 1 | same(0, 3) << 2 | same(1, 2) << 3 |
                               same(1, 3) << 4 | same(2, 3) << 5;
      for (size_t k = 0; k < 4 && !known; ++k) {
        const auto before = std::span(near).first(k);
        if (std::find(before.begin(), before.end(), near[k]) != before.end()) continue;  // asked already
        if (coder.bit(hit[pattern][k], value == near[k] ? 1 : 0) != 0) {
          value = near[k];
          known = true;
        }
      }
    }
    if (!known && (scale == Scale::kNames || alone)) {
      value = static_cast<int32_t>(names.code(coder, static_cast<uint32_t>(value)));
    } else if (!known) {
      const bool after = coder.bit(later, value > near[0] ? 1 : 0) != 0;
      const uint32_t distance_coded =
          distance.code(coder, static_cast<uint32_t>(std::max(std::abs(value - near[0]) - 1, 0)));
      if (distance_coded >= static_cast<uint32_t>(size)) return false;
      const auto step = static_cast<int32_t>(distance_coded);
      value = after ? near[0] + 1 + step : near[0] - 1 - step;
    }
    if (value < 0 || value >= size) return false;
    indices[i] = value;
  }
  return true;
}

template <typename Coder>
bool codeLevels(Coder& coder, std::span<const std::array<int16_t, 4>> neighbours, int32_t levels,
                std::vector<int32_t>& values) {
  values.resize(neighbours.size());
  std::array<SmallNumber, 5> residual;  // by how much the neighbours differ
  for (size_t i = 0; i < neighbours.size(); ++i) {
    if (coder.overrun()) return false;
    int32_t expected = levels / 2;
    size_t context = 4;
    if (neighbours[i][0] >= 0) {
      const auto near = [&](size_t k) { return values[static_cast<size_t>(neighbours[i][k])]; };
      expected = (2 * near(0) + 2 * near(1) + near(2) + near(3) + 3) / 6;
      const int32_t spread = std::abs(near(0) - near(1)) + std::abs(near(1) - near(2));
      context = spread == 0 ? 0 : spread < 4 ? 1 : spread < 12 ? 2 : 3;
    }
    const uint32_t coded = residual[context].code(coder, zigzag(values[i] - expected));
    if (coded > static_cast<uint32_t>(2 * levels)) return false;
    values[i] = expected + unzigzag(coded);
    if (values[i] < 0 || values[i] >= levels) return false;
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

template Occupancy codeOccupancy(Encoder&, const Occupancy&);
template Occupancy codeOccupancy(Decoder&, const Occupancy&);
template bool codeIndices(Encoder&, std::span<const std::array<int16_t, 4>>, int32_t, Scale,
                          std::vector<int32_t>&);
template bool codeIndices(Decoder&, std::span<const std::array<int16_t, 4>>, int32_t, Scale,
                          std::vector<int32_t>&);
template bool codeLevels(Encoder&, std::span<const std::array<int16_t, 4>>, int32_t, std::vector<int32_t>&);
template bool codeLevels(Decoder&, std::span<const std::array<int16_t, 4>>, int32_t, std::vector<int32_t>&);
template bool codePalette(Encoder&, int64_t, size_t, std::vector<int64_t>&);
template bool codePalette(Decoder&, int64_t, size_t, std::vector<int64_t>&);
template bool codeTimes(Encoder&, int64_t, size_t, std::vector<int64_t>&);
template bool codeTimes(Decoder&, int64_t, size_t, std::vector<int64_t>&);

}  // namespace shoal::wire
