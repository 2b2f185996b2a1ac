// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>

namespace shoal::comms {

/// The fullest second of a mission, against what was allowed in it. Bytes on the wire.
struct WorstWindow {
  int64_t bytes = 0;
  int64_t budget = 0;  ///< max(bytes_per_s x 1 s, the datagram when it stands alone); 0 = unlimited.
};

/// Says when a datagram may be sent so that every window of T >= 1 s of mission time holds at most
/// max(bytes_per_s x T, one datagram) bytes. Windows are closed at both ends.
///
/// Exact and work-conserving: a datagram of s bytes may go at time t if and only if for every earlier one,
/// sent at t_i, the bytes from it up to and with the new one are at most bytes_per_s x max(1 s, t - t_i).
/// With P_i the bytes sent before i and P those sent before now, that is P - P_i + s <= B, or
/// t >= t_i + (P - P_i + s) / B. Once more than B bytes were sent from i on, only the second branch is left,
/// and of all such i only the largest t_i B - P_i matters. All arithmetic is exact, in microseconds x
/// bytes/s.
///
/// What such a budget can carry: k = max(1, floor(B / s)) equal datagrams of s bytes fit a second, and k + 1
/// need (k + 1) s / B seconds, both ends included. That is k / (k + 1) of B: only half when a datagram takes
/// more than half a second's worth. See efficientDatagram().
///
/// Mission time does not run backwards: an earlier time than the last datagram's counts as that time.
/// Cost: O(1) amortised in spend(), O(datagrams in the oldest s bytes of the last B bytes) in earliest().
class Budget {
 public:
  /// @param bytes_per_s  0 = unlimited.
  /// @throws std::invalid_argument unless 0 <= bytes_per_s <= 10^12.
  explicit Budget(int64_t bytes_per_s);

  int64_t bytesPerSecond() const { return bytes_per_s_; }

  /// The first time >= now_us at which `bytes` > 0 may be sent.
  int64_t earliest(int64_t now_us, size_t bytes) const;

  /// Counts a datagram as sent. Aborts when earliest() did not allow it: over budget is our own bug.
  void spend(int64_t at_us, size_t bytes);

  /// What was sent up to at_us is unknown (a process came back after a crash): supposes the worst, that is
  /// max(bytes_per_s x 1 s, largest_datagram) bytes at that very time.
  void assumeExhausted(int64_t at_us, size_t largest_datagram);

  /// The fullest second so far; assumed bytes are not in it.
  WorstWindow worst() const { return worst_; }

 private:
  __extension__ using Wide = __int128;
  struct Sent {
    int64_t at_us;
    int64_t before;  // bytes sent before this datagram
  };

  Wide key(const Sent& sent) const;
  void measure(int64_t at_us);

  int64_t bytes_per_s_;
  int64_t last_us_;
  int64_t sent_ = 0;         // bytes in all
  std::deque<Sent> recent_;  // from each of these on, at most bytes_per_s_ bytes were sent
  Wide binding_;             // largest key() among all others
  std::deque<Sent> second_;  // datagrams of the last second
  WorstWindow worst_;
};

/// The wire size, up to kMaxWireBytes, of datagrams that carry most under a budget when each costs `overhead`
/// < 1000 bytes that are no content: the largest (s - overhead) / s x k / (k + 1), see Budget.
size_t efficientDatagram(int64_t bytes_per_s, size_t overhead);

}  // namespace shoal::comms
