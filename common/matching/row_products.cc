// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/matching/row_products.h"

#include <algorithm>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

namespace shoal::matching {
namespace {

constexpr size_t kBlock = WholeRows::kBlock;
constexpr size_t kSumLanes = 4;
constexpr size_t kAtOnce = 4096;

// sums[i][j] = Σ a_i b_j over `count` numbers, a multiple of kSumLanes; rows lie `stride` apart.
using Multiply = void (*)(const double* a, const double* b, size_t stride, size_t count,
                          double (&sums)[kBlock][kBlock]);

void multiplyAnywhere(const double* a, const double* b, size_t stride, size_t count,
                      double (&sums)[kBlock][kBlock]) {
  for (size_t i = 0; i < kBlock; ++i) {
    for (size_t j = 0; j < kBlock; ++j) {
      double lane[kSumLanes] = {};
      for (size_t k = 0; k < count; k += kSumLanes)
        for (size_t l = 0; l < kSumLanes; ++l) lane[l] += a[i * stride + k + l] * b[j * stride + k + l];
      sums[i][j] = lane[0] + lane[1] + lane[2] + lane[3];
    }
  }
}

#if defined(__x86_64__)
__attribute__((target("avx2,fma"))) void multiplyAvx2(const double* a, const double* b, size_t stride,
                                                      size_t count, double (&sums)[kBlock][kBlock]) {
  // Twice two rows at a time: eight sums, that is enough to keep the multipliers busy.
  for (size_t i = 0; i < kBlock; i += 2) {
    const double* const a0 = a + i * stride;
    const double* const a1 = a0 + stride;
    __m256d sum[2][kBlock];
    for (auto& row : sum)
      for (__m256d& s : row) s = _mm256_setzero_pd();
    for (size_t k = 0; k < count; k += kSumLanes) {
      const __m256d x0 = _mm256_loadu_pd(a0 + k), x1 = _mm256_loadu_pd(a1 + k);
#pragma GCC unroll 4
      for (size_t j = 0; j < kBlock; ++j) {
        const __m256d y = _mm256_loadu_pd(b + j * stride + k);
        sum[0][j] = _mm256_fmadd_pd(x0, y, sum[0][j]);
        sum[1][j] = _mm256_fmadd_pd(x1, y, sum[1][j]);
      }
    }
    for (size_t r = 0; r < 2; ++r) {
      for (size_t j = 0; j < kBlock; ++j) {
        double lane[kSumLanes];
        _mm256_storeu_pd(lane, sum[r][j]);
        sums[i + r][j] = lane[0] + lane[1] + lane[2] + lane[3];
      }
    }
  }
}
#endif

Multiply fastest() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return &multiplyAvx2;
#endif
  return &multiplyAnywhere;
}

size_t roundedUp(size_t n, size_t step) { return (n + step - 1) / step * step; }

}  // namespace

WholeRows::WholeRows(size_t num_rows, size_t width)
    : num_blocks_(roundedUp(num_rows, kBlock) / kBlock),
      stride_(roundedUp(width, kSumLanes)),
      numbers_(num_blocks_ * kBlock * stride_) {}

std::array<std::array<int64_t, kBlock>, kBlock> WholeRows::products(size_t a, size_t b) const {
  static const Multiply multiply = fastest();
  std::array<std::array<int64_t, kBlock>, kBlock> result{};
  for (size_t first = 0; first < stride_; first += kAtOnce) {
    double sums[kBlock][kBlock];
    multiply(numbers_.data() + a * kBlock * stride_ + first, numbers_.data() + b * kBlock * stride_ + first,
             stride_, std::min(kAtOnce, stride_ - first), sums);
    for (size_t i = 0; i < kBlock; ++i)
      for (size_t j = 0; j < kBlock; ++j) result[i][j] += static_cast<int64_t>(sums[i][j]);
  }
  return result;
}

}  // namespace shoal::matching
