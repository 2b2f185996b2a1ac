// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/state_bytes.h"

#include <array>
#include <stdexcept>
#include <utility>

#include "shoal/demand.h"
#include "shoal/random.h"

namespace shoal::topics {
namespace {

constexpr size_t kKindBytes = 8;
constexpr size_t kChecksumBytes = 8;

uint64_t checksum(std::span<const uint8_t> bytes) {
  uint64_t hash = bytes.size();
  for (size_t first = 0; first < bytes.size(); first += 8) {
    uint64_t word = 0;
    for (size_t i = first; i < bytes.size() && i < first + 8; ++i)
      word |= uint64_t{bytes[i]} << 8 * (i - first);
    hash = hashCombine(hash, word);
  }
  return hash;
}

}  // namespace

StateWriter::StateWriter(const std::string& kind, uint32_t version) : bytes_(kind.begin(), kind.end()) {
  SHOAL_DEMAND(kind.size() == kKindBytes);
  u32(version);
}

std::vector<uint8_t> StateWriter::finish() && {
  u64(checksum(bytes_));
  return std::move(bytes_);
}

void StateWriter::bytes(std::span<const uint8_t> bytes) {
  u64(bytes.size());
  bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
}

void StateWriter::put(uint64_t value, int num_bytes) {
  std::array<uint8_t, 8> digits;
  for (size_t i = 0; i < digits.size(); ++i) digits[i] = static_cast<uint8_t>(value >> 8 * i);
  bytes_.insert(bytes_.end(), digits.begin(), digits.begin() + num_bytes);
}

StateReader::StateReader(std::span<const uint8_t> bytes, const std::string& kind, uint32_t version)
    : bytes_(bytes), kind_(kind) {
  SHOAL_DEMAND(kind.size() == kKindBytes);
  demand(bytes.size() >= kKindBytes + 4 + kChecksumBytes, "it is too short");
  for (const char letter : kind) {
    demand(get(1) == static_cast<uint8_t>(letter), "it is of another kind");
  }
  const uint32_t its_version = u32();
  demand(its_version == version,
         "its version is " + std::to_string(its_version) + ", this program reads " + std::to_string(version));
  const size_t body = bytes_.size() - kChecksumBytes;
  const uint64_t expected = checksum(bytes.first(bytes.size() - kChecksumBytes));
  const auto all = bytes_;
  bytes_ = all.subspan(body);
  demand(u64() == expected, "its checksum does not fit: it is damaged");
  bytes_ = all.first(body);
}

size_t StateReader::count(size_t least_bytes) {
  const uint64_t number = u64();
  demand(number <= bytes_.size() / least_bytes, "a count is larger than what follows");
  return static_cast<size_t>(number);
}

std::span<const uint8_t> StateReader::bytes() {
  const size_t number = count(1);
  const auto part = bytes_.first(number);
  bytes_ = bytes_.subspan(number);
  return part;
}

void StateReader::demand(bool holds, const std::string& what) const {
  if (!holds) throw std::runtime_error("checkpoint \"" + kind_ + "\" refused: " + what);
}

uint64_t StateReader::get(size_t num_bytes) {
  demand(bytes_.size() >= num_bytes, "it ends too early");
  uint64_t value = 0;
  for (size_t i = 0; i < num_bytes; ++i) value |= uint64_t{bytes_[i]} << 8 * i;
  bytes_ = bytes_.subspan(num_bytes);
  return value;
}

}  // namespace shoal::topics
