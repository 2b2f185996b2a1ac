// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/tile_memory.h"

#include <cstring>

namespace shoal::mapping {

TileMemory::TileMemory(size_t size)
    : data_(static_cast<std::byte*>(::operator new (size, std::align_val_t{kLine}))), size_(size) {
  std::memset(data_, 0, size);
}

TileMemory::TileMemory(const TileMemory& other) {
  if (other.size_ == 0) return;
  TileMemory copy(other.size_);
  std::memcpy(copy.data_, other.data_, other.size_);
  std::swap(data_, copy.data_);
  std::swap(size_, copy.size_);
}

TileMemory::~TileMemory() { ::operator delete (data_, std::align_val_t{kLine}); }

}  // namespace shoal::mapping
