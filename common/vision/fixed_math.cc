// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/vision/fixed_math.h"

#include <array>
#include <bit>
#include <cmath>

#include "shoal/demand.h"

namespace shoal::vision {
namespace {

constexpr int kExponentBits = 16;
constexpr uint64_t kOne = uint64_t{1} << 31;  // of a mantissa

// Element i is 2^(2^-(i + 1)) as a mantissa: square roots of square roots of 2.
std::array<uint64_t, kExponentBits> rootsOfTwo() {
  std::array<uint64_t, kExponentBits> roots{};
  uint64_t root = 2 * kOne;
  for (uint64_t& r : roots) r = root = integerSquareRoot(root * kOne);
  return roots;
}

}  // namespace

int32_t fixedLog2(uint64_t x, int bits) {
  SHOAL_DEMAND(x >= 1 && bits >= 0 && bits <= 16);
  int32_t log = 63 - std::countl_zero(x);
  uint64_t mantissa = log <= 31 ? x << (31 - log) : x >> (log - 31);  // in [kOne, 2 kOne)
  for (int i = 0; i < bits; ++i) {
    mantissa = (mantissa * mantissa) >> 31;  // in [kOne, 4 kOne)
    const auto carry = static_cast<int32_t>(mantissa >> 32);
    mantissa >>= carry;
    log = 2 * log + carry;
  }
  return log;
}

uint64_t fixedExp2(int32_t exponent) {
  SHOAL_DEMAND(exponent >= -(1 << 20) && exponent < 1 << 20);
  static const std::array<uint64_t, kExponentBits> roots = rootsOfTwo();
  uint64_t mantissa = kOne;
  for (int i = 0; i < kExponentBits; ++i) {
    if (exponent & (1 << (kExponentBits - 1 - i))) {
      mantissa = (mantissa * roots[static_cast<size_t>(i)]) >> 31;
    }
  }
  const int whole = exponent >> kExponentBits;  // rounds down, in [-16, 15]
  return mantissa >> (15 - whole);
}

uint64_t integerSquareRoot(uint64_t x) {
  SHOAL_DEMAND(x <= uint64_t{1} << 63);
  auto root = static_cast<uint64_t>(std::sqrt(static_cast<double>(x)));
  while (root * root > x) --root;
  while ((root + 1) * (root + 1) <= x) ++root;
  return root;
}

uint64_t integerCubeRoot(uint64_t x) {
  SHOAL_DEMAND(x <= uint64_t{1} << 60);
  auto root = static_cast<uint64_t>(std::cbrt(static_cast<double>(x)));
  while (root * root * root > x) --root;
  while ((root + 1) * (root + 1) * (root + 1) <= x) ++root;
  return root;
}

}  // namespace shoal::vision
