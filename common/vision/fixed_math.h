// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace shoal::vision {

/// Logarithms, powers and roots in integers, so that words are equal on every machine: libm may round
/// differently from one C library to the next.

/// log2(x) in steps of 2^-bits, never above the true value and less than 1.01 steps below it; not decreasing.
/// Cost: `bits` multiplications.
/// @param x     >= 1.
/// @param bits  in [0, 16].
int32_t fixedLog2(uint64_t x, int bits);

/// 2^(exponent / 65536) in steps of 2^-16, never above the true value and less than one step and a 10^-7th
/// of it below.
/// @param exponent  in [-2^20, 2^20).
uint64_t fixedExp2(int32_t exponent);

/// The largest integer whose square is at most x.
/// @param x  at most 2^63.
uint64_t integerSquareRoot(uint64_t x);

/// The largest integer whose cube is at most x.
/// @param x  at most 2^60.
uint64_t integerCubeRoot(uint64_t x);

}  // namespace shoal::vision
