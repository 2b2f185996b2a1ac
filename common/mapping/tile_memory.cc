// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/tile_memory.h"

#include <algorithm>
#include <cstring>

namespace shoal::mapping {

TileMemory::TileMemory(size_t size)
    : data_(static_cast<std::byte*>(::operator new (size, std::align_val_t{kLine}))), size_(size) {
  std::memset(data_, 0, size);
}

TileMemory::TileMemory(const TileMemory& other) : TileMemory(other.size_) {
  std::copy_n(other.data_, size_, data_);
}

TileMemory::~TileMemory() { ::operator delete (data_, std::align_val_t{kLine}); }

}  // namespace shoal::mapping
