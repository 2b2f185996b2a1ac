// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <new>
#include <utility>

namespace shoal::mapping {

/// The bytes of a tile: one piece of memory that begins with a cache line, zero at first.
class TileMemory {
 public:
  static constexpr size_t kLine = 64;

  TileMemory() = default;
  explicit TileMemory(size_t size);
  TileMemory(const TileMemory& other);
  TileMemory(TileMemory&& other) noexcept
      : data_(std::exchange(other.data_, nullptr)), size_(std::exchange(other.size_, 0)) {}
  TileMemory& operator=(TileMemory other) noexcept {
    std::swap(data_, other.data_);
    std::swap(size_, other.size_);
    return *this;
  }
  ~TileMemory();

  std::byte* data() { return data_; }
  const std::byte* data() const { return data_; }
  size_t size() const { return size_; }

 private:
  std::byte* data_ = nullptr;
  size_t size_ = 0;
};

}  // namespace shoal::mapping
