// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/range_coder.h"

#include <utility>

namespace shoal::wire {
namespace {

constexpr uint32_t kTop = 1u << 24;

}  // namespace

void Encoder::shiftLow() {
  if (low_ < 0xff000000u || low_ > 0xffffffffu) {
    const auto carry = static_cast<uint8_t>(low_ >> 32);
    for (; pending_ > 0; --pending_) {
      if (!first_) out_.push_back(static_cast<uint8_t>(cache_ + carry));
      first_ = false;
      cache_ = 0xff;
    }
    cache_ = static_cast<uint8_t>(low_ >> 24);
  }
  ++pending_;
  low_ = (low_ & 0x00ffffffu) << 8;
}

void Encoder::normalize() {
  while (range_ < kTop) {
    range_ <<= 8;
    shiftLow();
  }
}

int Encoder::bit(uint32_t zero, int value) {
  const uint32_t bound = (range_ >> 16) * zero;
  if (value == 0) {
    range_ = bound;
  } else {
    low_ += bound;
    range_ -= bound;
  }
  normalize();
  return value;
}

int Encoder::bit(AdaptiveBit& model, int value) {
  bit(uint32_t{model.zero}, value);
  model.update(value);
  return value;
}

uint64_t Encoder::direct(uint64_t value, int bits) {
  for (int i = bits - 1; i >= 0; --i) {
    range_ >>= 1;
    if ((value >> i & 1) != 0) low_ += range_;
    normalize();
  }
  return value;
}

Bytes Encoder::finish() {
  // Of all numbers in [low, low + range), the one with the most zero bytes at its end; those stay unwritten.
  for (int bytes = 0; bytes <= 4; ++bytes) {
    const uint64_t rest = (uint64_t{1} << (32 - 8 * bytes)) - 1;
    const uint64_t value = (low_ + rest) & ~rest;
    if (value >= low_ + range_) continue;
    low_ = value;
    for (int i = 0; i <= bytes; ++i) shiftLow();
    break;
  }
  return std::move(out_);
}

Decoder::Decoder(std::span<const uint8_t> bytes) : bytes_(bytes) {
  for (int i = 0; i < 4; ++i) code_ = code_ << 8 | next();
}

uint8_t Decoder::next() {
  if (position_ < bytes_.size()) return bytes_[position_++];
  ++past_end_;
  return 0;
}

void Decoder::normalize() {
  while (range_ < kTop) {
    range_ <<= 8;
    code_ = code_ << 8 | next();
  }
}

int Decoder::bit(uint32_t zero, int /*ignored*/) {
  const uint32_t bound = (range_ >> 16) * zero;
  int value = 0;
  if (code_ < bound) {
    range_ = bound;
  } else {
    code_ -= bound;
    range_ -= bound;
    value = 1;
  }
  normalize();
  return value;
}

int Decoder::bit(AdaptiveBit& model, int /*ignored*/) {
  const int value = bit(uint32_t{model.zero});
  model.update(value);
  return value;
}

uint64_t Decoder::direct(uint64_t /*ignored*/, int bits) {
  uint64_t value = 0;
  for (int i = 0; i < bits; ++i) {
    range_ >>= 1;
    const bool one = code_ >= range_;
    if (one) code_ -= range_;
    value = value << 1 | (one ? 1u : 0u);
    normalize();
  }
  return value;
}

}  // namespace shoal::wire
