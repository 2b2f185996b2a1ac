// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>
#include <vector>

namespace shoal::topics {

/// A vector that grows without moving what it holds: in blocks, so that to add one element never costs a copy
/// of a million.
template <typename T>
class SteadyVector {
 public:
  class Iterator {
   public:
    Iterator(const SteadyVector& vector, size_t at) : vector_(vector), at_(at) {}
    const T& operator*() const { return vector_[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    bool operator!=(const Iterator& other) const { return at_ != other.at_; }

   private:
    const SteadyVector& vector_;
    size_t at_;
  };

  size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  T& operator[](size_t i) { return blocks_[i / kBlock][i % kBlock]; }
  const T& operator[](size_t i) const { return blocks_[i / kBlock][i % kBlock]; }
  T& back() { return (*this)[size_ - 1]; }

  void push_back(T value) {
    if (size_ % kBlock == 0) blocks_.emplace_back().reserve(kBlock);
    blocks_.back().push_back(std::move(value));
    ++size_;
  }

  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size_}; }

 private:
  static constexpr size_t kBlock = 1024;

  std::vector<std::vector<T>> blocks_;  // all full but the last
  size_t size_ = 0;
};

}  // namespace shoal::topics
