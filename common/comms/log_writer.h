// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "shoal/comms/packet.h"

namespace shoal::comms {

/// A packet as an event of an LCM log, as LogReader reads it.
/// @param number  Of the event, from 0.
void appendLogEvent(Bytes& out, const Packet& packet, uint64_t number, int64_t time_us);

/// Appends packets to an LCM log. What append() has written survives the death of the process: it is with the
/// system, whole events at once. A torn end that a crash of the whole machine may leave is passed over by
/// LogReader.
class LogWriter {
 public:
  /// Opens for appending; makes the file and its folder when they are missing.
  /// @throws std::runtime_error naming the file when it cannot be opened.
  explicit LogWriter(const std::string& path);
  ~LogWriter();
  LogWriter(const LogWriter&) = delete;
  LogWriter& operator=(const LogWriter&) = delete;

  /// @throws std::runtime_error naming the file when the disk is full.
  void append(const Packet& packet, int64_t time_us);

  uint64_t bytes() const { return bytes_; }  ///< In the file.

 private:
  std::string path_;
  int fd_;
  uint64_t bytes_ = 0;
  uint64_t num_appended_ = 0;
};

}  // namespace shoal::comms
