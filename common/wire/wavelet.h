// SPDX-License-Identifier: BSD-3-Clause
#pragma once

// For picture_coder.cc: the reversible 5/3 wavelet (Le Gall and Tabatabai 1988; JPEG 2000, ISO/IEC 15444-1
// annex F) on small squares of integers, borders mirrored.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace shoal::wire {

/// A square of numbers, row by row.
struct Square {
  int edge = 0;
  std::vector<int32_t> values = {};

  explicit Square(int edge_in)
      : edge(edge_in), values(static_cast<size_t>(edge_in) * static_cast<size_t>(edge_in)) {}
  int32_t& at(int x, int y) { return values[static_cast<size_t>(y * edge + x)]; }
  int32_t at(int x, int y) const { return values[static_cast<size_t>(y * edge + x)]; }
};

/// One line of n numbers, n even: the low half comes first afterwards.
inline void analyze(int32_t* line, int n) {
  std::vector<int32_t> low(static_cast<size_t>(n / 2)), high(static_cast<size_t>(n / 2));
  for (int i = 0; i < n / 2; ++i) {
    const int32_t right = line[std::min(2 * i + 2, n - 2)];
    high[static_cast<size_t>(i)] = line[2 * i + 1] - ((line[2 * i] + right) >> 1);
  }
  for (int i = 0; i < n / 2; ++i) {
    const int32_t left = high[static_cast<size_t>(std::max(i - 1, 0))];
    low[static_cast<size_t>(i)] = line[2 * i] + ((left + high[static_cast<size_t>(i)] + 2) >> 2);
  }
  std::copy(low.begin(), low.end(), line);
  std::copy(high.begin(), high.end(), line + n / 2);
}

/// The inverse of analyze().
inline void synthesize(int32_t* line, int n) {
  std::vector<int32_t> whole(static_cast<size_t>(n));
  const int32_t* high = line + n / 2;
  for (int i = 0; i < n / 2; ++i) {
    whole[static_cast<size_t>(2 * i)] = line[i] - ((high[std::max(i - 1, 0)] + high[i] + 2) >> 2);
  }
  for (int i = 0; i < n / 2; ++i) {
    const int32_t right = whole[static_cast<size_t>(std::min(2 * i + 2, n - 2))];
    whole[static_cast<size_t>(2 * i + 1)] = high[i] + ((whole[static_cast<size_t>(2 * i)] + right) >> 1);
  }
  std::copy(whole.begin(), whole.end(), line);
}

/// A step on every row, or every column, of the top left n x n.
template <typename Step>
void onRows(Square& square, int n, Step&& step) {
  for (int y = 0; y < n; ++y) step(&square.at(0, y), n);
}
template <typename Step>
void onColumns(Square& square, int n, Step&& step) {
  std::vector<int32_t> column(static_cast<size_t>(n));
  for (int x = 0; x < n; ++x) {
    for (int y = 0; y < n; ++y) column[static_cast<size_t>(y)] = square.at(x, y);
    step(column.data(), n);
    for (int y = 0; y < n; ++y) square.at(x, y) = column[static_cast<size_t>(y)];
  }
}

/// In place, down to a low band of `low` x `low` at the top left.
inline void analyze(Square& square, int low) {
  for (int n = square.edge; n > low; n /= 2) {
    onRows(square, n, [](int32_t* line, int m) { analyze(line, m); });
    onColumns(square, n, [](int32_t* line, int m) { analyze(line, m); });
  }
}
inline void synthesize(Square& square, int low) {
  for (int n = 2 * low; n <= square.edge; n *= 2) {
    onColumns(square, n, [](int32_t* line, int m) { synthesize(line, m); });
    onRows(square, n, [](int32_t* line, int m) { synthesize(line, m); });
  }
}

}  // namespace shoal::wire
