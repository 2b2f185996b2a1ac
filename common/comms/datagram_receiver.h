// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>
#include <thread>

#include "shoal/comms/lcm_url.h"
#include "shoal/comms/packet.h"

namespace shoal::comms {

/// What a receiver did with what it heard on channels that begin like ours.
struct DatagramCounts {
  uint64_t dropped = 0;      ///< The queue was full, or memory was.
  uint64_t bad_channel = 0;  ///< Begins like ours but is not SHOAL_<NODE>_<KIND>.
  uint64_t bad_size = 0;     ///< Larger than any message of ours.
};

/// Hears a multicast group without liblcm, whose receiving thread crafted fragments crash, in all versions
/// known. Our messages are never in fragments (LC03), so that none is looked at: a datagram is LC02, a
/// sequence number (4 bytes), the channel, a NUL, the message. A thread of its own empties the kernel's
/// buffer, whatever its owner does meanwhile.
class DatagramReceiver {
 public:
  /// @param max_queue  packets kept until take(); what comes above that is dropped and counted.
  /// @throws std::runtime_error saying what the kernel refused.
  DatagramReceiver(const LcmUrl& url, size_t max_queue);
  ~DatagramReceiver();
  DatagramReceiver(const DatagramReceiver&) = delete;
  DatagramReceiver& operator=(const DatagramReceiver&) = delete;

  /// All that waits, in the order in which it came.
  std::deque<Packet> take();

  /// Readable while something waits.
  int fileDescriptor() const { return ready_; }

  DatagramCounts counts() const;

 private:
  void run();
  void hear(const uint8_t* bytes, size_t size);

  size_t max_queue_;
  int socket_ = -1, ready_ = -1, stop_ = -1;
  mutable std::mutex mutex_;
  std::deque<Packet> queue_;  // guarded by mutex_
  DatagramCounts counts_;     // guarded by mutex_
  std::thread thread_;
};

}  // namespace shoal::comms
