// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace shoal::topics {

/// A learner's state as bytes: eight letters that say what it is, a version, the numbers, a checksum.
/// All little-endian, so that a checkpoint moves between machines.
class StateWriter {
 public:
  /// @param kind  Eight characters.
  StateWriter(const std::string& kind, uint32_t version);

  /// Makes room for so many bytes more.
  void reserve(size_t bytes) { bytes_.reserve(bytes_.size() + bytes); }

  void u64(uint64_t value) { put(value, 8); }
  void i64(int64_t value) { u64(static_cast<uint64_t>(value)); }
  void u32(uint32_t value) { put(value, 4); }
  void i32(int32_t value) { u32(static_cast<uint32_t>(value)); }

  /// Bytes of another's, and how many they are.
  void bytes(std::span<const uint8_t> bytes);

  /// All that was written, with its checksum.
  std::vector<uint8_t> finish() &&;

 private:
  void put(uint64_t value, int num_bytes);

  std::vector<uint8_t> bytes_;
};

/// Reads what StateWriter wrote. Bytes that are not that are refused before anything is read.
class StateReader {
 public:
  /// @throws std::runtime_error naming what is wrong: too short, another kind, another version, a checksum
  ///         that does not fit.
  StateReader(std::span<const uint8_t> bytes, const std::string& kind, uint32_t version);

  /// @throws std::runtime_error past the end.
  uint64_t u64() { return get(8); }
  int64_t i64() { return static_cast<int64_t>(u64()); }
  uint32_t u32() { return static_cast<uint32_t>(get(4)); }
  int32_t i32() { return static_cast<int32_t>(u32()); }

  /// A count of things that take at least `least_bytes` each, so that no more is made room for than can
  /// follow.
  /// @throws std::runtime_error for more than that.
  size_t count(size_t least_bytes);

  /// What StateWriter::bytes() wrote: a part of what is read.
  /// @throws std::runtime_error for more than follows.
  std::span<const uint8_t> bytes();

  /// @throws std::runtime_error naming `what` unless `holds`.
  void demand(bool holds, const std::string& what) const;

  /// @throws std::runtime_error if something is left.
  void finish() const { demand(bytes_.empty(), "bytes are left over"); }

 private:
  uint64_t get(size_t num_bytes);

  std::span<const uint8_t> bytes_;
  std::string kind_;
};

}  // namespace shoal::topics
