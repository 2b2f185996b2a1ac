// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/bag/cdr_reader.h"

#include <bit>

namespace shoal::console {
namespace {

constexpr size_t kEncapsulation = 4;

}  // namespace

CdrReader::CdrReader(std::span<const uint8_t> bytes) {
  if (bytes.size() < kEncapsulation || bytes[0] != 0 || bytes[1] > 1) {  // PL_CDR and XCDR2 are others
    good_ = false;
    return;
  }
  is_big_ = bytes[1] == 0;
  body_ = bytes.subspan(kEncapsulation);
}

std::span<const uint8_t> CdrReader::take(size_t size, size_t alignment) {
  const size_t first = (at_ + alignment - 1) / alignment * alignment;
  if (!good_ || first > body_.size() || size > body_.size() - first) {
    good_ = false;
    return {};
  }
  at_ = first + size;
  return body_.subspan(first, size);
}

uint64_t CdrReader::number(size_t size) {
  const auto taken = take(size, size);
  uint64_t value = 0;
  for (size_t i = 0; i < taken.size(); ++i) {
    value = value << 8 | taken[is_big_ ? i : taken.size() - 1 - i];
  }
  return value;
}

uint8_t CdrReader::u8() { return static_cast<uint8_t>(number(1)); }
uint32_t CdrReader::u32() { return static_cast<uint32_t>(number(4)); }
double CdrReader::f64() { return std::bit_cast<double>(number(8)); }

std::string CdrReader::string() {
  const uint32_t size = u32();  // with its NUL; some writers leave the NUL of an empty one out
  if (size > kMaxString) good_ = false;
  const auto taken = take(good_ ? size : 0, 1);
  std::string text(taken.begin(), taken.end());
  if (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::span<const uint8_t> CdrReader::bytes() {
  const uint32_t size = u32();
  return take(size, 1);
}

bool CdrReader::anyOfDoubles() {
  const uint32_t size = u32();
  if (size > body_.size() / 8) good_ = false;
  bool any = false;
  for (uint32_t i = 0; good_ && i < size; ++i) any |= f64() != 0;
  return any;
}

}  // namespace shoal::console
