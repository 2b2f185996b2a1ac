// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/cell_field.h"

#include <algorithm>
#include <cstdlib>

namespace shoal::wire {
namespace {

constexpr int kEdge = mapping::kBrickEdge;

}  // namespace

void CellField::beginBrick(const std::array<int32_t, 3>& brick) {
  brick_ = brick;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      const auto found = tiles_.find({brick[0] + dx, brick[1] + dy});
      around_[static_cast<size_t>(3 * (dy + 1) + dx + 1)] =
          found == tiles_.end() ? nullptr : found->second.get();
    }
  }
  if (around_[4] != nullptr) return;
  auto tile = std::make_unique<Tile>();
  tile->fill(-1);
  around_[4] = tile.get();
  tiles_.emplace(std::pair(brick[0], brick[1]), std::move(tile));
}

void CellField::add(int x, int y, int z) {
  const world::CellIndex cell{brick_[0] * kEdge + x, brick_[1] * kEdge + y, brick_[2] * kEdge + z};
  NearCells near;
  for (size_t k = 0; k < kNearColumns.size(); ++k)
    near[k] = nearest(x + kNearColumns[k].dx, y + kNearColumns[k].dy, cell.z);
  int32_t& last = (*around_[4])[static_cast<size_t>(x * kEdge + y)];
  near.back() = last >= 0 && cells_[static_cast<size_t>(last)].z == cell.z - 1 ? last : -1;
  below_.push_back(last);
  last = static_cast<int32_t>(cells_.size());
  cells_.push_back(cell);
  near_.push_back(near);
}

int32_t CellField::lastOf(int x, int y) const {
  const Tile* tile = around_[static_cast<size_t>(3 * ((y >> 4) + 1) + (x >> 4) + 1)];
  return tile == nullptr ? -1 : (*tile)[static_cast<size_t>((x & 15) * kEdge + (y & 15))];
}

// The cell of a column nearest to an absolute height, the lower of two.
int32_t CellField::nearest(int x, int y, int32_t z) const {
  int32_t best = lastOf(x, y);
  if (best < 0) return -1;
  const auto distance = [&](int32_t i) {
    return std::abs(int64_t{cells_[static_cast<size_t>(i)].z} - int64_t{z});
  };
  for (int32_t next = below_[static_cast<size_t>(best)]; next >= 0 && distance(next) <= distance(best);
       next = below_[static_cast<size_t>(next)]) {
    best = next;
  }
  return best;
}

bool CellField::at(int x, int y, int z) const {
  const int height = nearestHeight(x, y, z);
  return height == z;
}

int CellField::nearestHeight(int x, int y, int z) const {
  const int32_t i = nearest(x, y, brick_[2] * kEdge + z);
  return i < 0 ? kNone : cells_[static_cast<size_t>(i)].z - brick_[2] * kEdge;
}

std::vector<CellField::Shape> CellField::shapes() const {
  std::vector<Shape> shapes(cells_.size());
  for (size_t i = 0; i < cells_.size(); ++i) {
    const auto step = [&](int32_t near) {
      if (near < 0) return uint8_t{0};
      const int64_t height = int64_t{cells_[static_cast<size_t>(near)].z} - int64_t{cells_[i].z};
      return static_cast<uint8_t>(std::clamp<int64_t>(height, -2, 2) + 3);
    };
    shapes[i].west = step(near_[i][0]);
    shapes[i].south = step(near_[i][1]);
    int32_t below = below_[i];
    for (uint8_t n = 1; n <= 2 && below >= 0; ++n, below = below_[static_cast<size_t>(below)]) {
      shapes[i].below = n;
      uint8_t& above = shapes[static_cast<size_t>(below)].above;
      above = std::max(above, n);
    }
  }
  return shapes;
}

uint32_t CellField::heights(int x, int y) const {
  const int64_t least = int64_t{brick_[2]} * kEdge - 1;
  uint32_t heights = 0;
  for (int32_t i = lastOf(x, y); i >= 0; i = below_[static_cast<size_t>(i)]) {
    const int64_t height = cells_[static_cast<size_t>(i)].z - least;
    if (height < 0) break;
    if (height <= kEdge + 1) heights |= 1u << height;
  }
  return heights;
}

}  // namespace shoal::wire
