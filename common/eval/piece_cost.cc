// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/piece_cost.h"

#include "shoal/wire/piece_codec.h"

namespace shoal::eval {
namespace {

// A channel of 16 letters and its NUL, LCM's header 8, UDP 8, IP 20.
constexpr int64_t kHeaderBytes = 53;
constexpr size_t kMaxPayload = 1300;

}  // namespace

PieceCost& PieceCost::operator+=(const PieceCost& other) {
  bytes += other.bytes;
  datagrams += other.datagrams;
  return *this;
}

PieceCost costOf(const mapping::Piece& whole) {
  PieceCost cost;
  for (const mapping::Piece& part : wire::cutToFit(whole, kMaxPayload)) {
    cost += {std::ssize(wire::encode(part, 1, world::Timestamp{})) + kHeaderBytes, 1};
  }
  return cost;
}

}  // namespace shoal::eval
