// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "shoal/comms/bus.h"

namespace shoal::comms {

struct LcmBusOptions {
  /// Packets kept between two deliveries, >= 1. What comes when so many wait is dropped and counted.
  size_t max_queue = 16384;
  /// Instead of ours, these channels of others, as [A-Za-z0-9_]{1,63}: a robot's cameras. LCM then keeps at
  /// most max_queue messages for us as well, and drops the newest without a count.
  std::vector<std::string> channels = {};
  /// Everybody's channels, but for LCM's own self test: to look on. Likewise.
  bool everything = false;
  /// What LCM header, channel, NUL and payload may take together; for channels of others, where LCM cuts
  /// what is larger than a datagram. In [1400, 2^28].
  size_t max_message_bytes = kMaxMessageBytes;
};

/// What LcmBus did with what it heard on our channels.
struct LcmBusCounts {
  uint64_t received = 0;     ///< Delivered to a handler.
  uint64_t dropped = 0;      ///< The queue was full, or memory was.
  uint64_t bad_channel = 0;  ///< Begins like ours but is not SHOAL_<NODE>_<KIND>.
  uint64_t bad_size = 0;     ///< Above max_message_bytes.
};

/// A multicast group as LCM speaks it. Our own channels are heard by DatagramReceiver, those of others by
/// LCM, which can be crashed by crafted fragments; either has a receiving thread of its own. Handlers run in
/// the thread that calls receive(), outside of both, so that they may throw and publish. Only packets on
/// channels of ours (or those of the options) and of legal size are delivered; their bytes are not looked at.
class LcmBus final : public Bus {
 public:
  /// @param url  As parseUrl(); recv_buf_size is added when absent.
  /// @throws std::invalid_argument for a bad URL or option, std::runtime_error, with the command that may
  /// help,
  ///         when LCM cannot use the network.
  explicit LcmBus(const std::string& url, const LcmBusOptions& options = {});
  ~LcmBus() override;
  LcmBus(const LcmBus&) = delete;
  LcmBus& operator=(const LcmBus&) = delete;

  /// Aborts for a message above max_message_bytes or on a channel that is not ours (or of the options).
  void publish(const Packet& packet) override;

  int receive(int timeout_ms, const std::function<void(const Packet&)>& handler) override;

  /// Readable when something waits: for poll() together with other descriptors.
  int fileDescriptor() const;

  /// The URL in use.
  const std::string& url() const;

  const LcmBusCounts& counts() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace shoal::comms
