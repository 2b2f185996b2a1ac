// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/fixed_log.h"

#include <array>
#include <bit>

#include "shoal/demand.h"

namespace shoal::matching {
namespace {

__extension__ using UnsignedWide = unsigned __int128;

constexpr int kTableBits = 11;
constexpr int kMantissaBits = 62;  // a mantissa in [1, 2) is in [2^62, 2^63)

// log2 of a mantissa, bit by bit: squaring doubles the logarithm, and where that passes 2 there is a 1.
constexpr int64_t byBits(uint64_t mantissa) {
  int64_t log = 0;
  for (int bit = kLogBits - 1; bit >= 0; --bit) {
    UnsignedWide square = static_cast<UnsignedWide>(mantissa) * mantissa >> kMantissaBits;
    if (square >> (kMantissaBits + 1) != 0) {
      log |= int64_t{1} << bit;
      square >>= 1;
    }
    mantissa = static_cast<uint64_t>(square);
  }
  return log;
}

// log2 at the lower end of each of 2048 equal parts of [1, 2).
const std::array<int64_t, 1 << kTableBits>& table() {
  static const auto values = [] {
    std::array<int64_t, 1 << kTableBits> logs{};
    for (size_t i = 0; i < logs.size(); ++i) {
      logs[i] =
          byBits((uint64_t{1} << kMantissaBits) + (static_cast<uint64_t>(i) << (kMantissaBits - kTableBits)));
    }
    return logs;
  }();
  return values;
}

}  // namespace

int64_t fixedLog2(int64_t x) {
  SHOAL_DEMAND(x >= 1 && x <= int64_t{1} << 62);
  const auto bits = static_cast<uint64_t>(x);
  const int exponent = 63 - std::countl_zero(bits);
  const uint64_t mantissa = bits << (kMantissaBits - exponent);
  const uint64_t part = (mantissa >> (kMantissaBits - kTableBits)) - (uint64_t{1} << kTableBits);
  const uint64_t lower = (uint64_t{1} << kMantissaBits) + (part << (kMantissaBits - kTableBits));

  // mantissa = lower (1 + d), d < 2^-11: log2(1 + d) = (d - d²/2 + d³/3) log2(e), the rest is below 2^-45.
  const auto d =
      static_cast<uint64_t>((static_cast<UnsignedWide>(mantissa - lower) << kMantissaBits) / lower);
  const auto square = static_cast<uint64_t>(static_cast<UnsignedWide>(d) * d >> kMantissaBits);
  const auto cube = static_cast<uint64_t>(static_cast<UnsignedWide>(square) * d >> kMantissaBits);
  const uint64_t natural = d - square / 2 + cube / 3;
  constexpr uint64_t kLog2E = 0x5c551d94ae0bf85d;  // log2(e) 2^62
  const auto rest = static_cast<uint64_t>(static_cast<UnsignedWide>(natural) * kLog2E >> kMantissaBits);
  return (static_cast<int64_t>(exponent) << kLogBits) + table()[part] +
         static_cast<int64_t>(rest >> (kMantissaBits - kLogBits));
}

}  // namespace shoal::matching
