// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

namespace shoal::matching {

/// Fraction bits of fixedLog2().
inline constexpr int kLogBits = 40;

/// log2(x) in units of 2^-40, to 2^-38 and the same on every machine: integers alone, where the libraries'
/// logarithms differ in their last bits. fixedLog2(2 x) is fixedLog2(x) plus one whole unit, 2^40.
///
/// @param x  in [1, 2^62].
/// Cost: a look-up and three products.
int64_t fixedLog2(int64_t x);

}  // namespace shoal::matching
