// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "shoal/comms/packet.h"

namespace shoal::comms {

/// A message as lcm-logger wrote it.
struct LogEvent {
  int64_t time_us =
      0;  ///< When the logger received it, wall time, microseconds since 1970. May run backwards.
  Packet packet;
};

struct LogCounts {
  uint64_t good = 0;     ///< Events delivered.
  uint64_t large = 0;    ///< Intact events with more than kMaxLogPayload bytes, passed over.
  uint64_t damaged = 0;  ///< Stretches passed over to find the next event, a torn end included.
  uint64_t damaged_bytes = 0;
};

/// No event with more payload is delivered; ours are below 1400 bytes, cameras' in the same log are not.
inline constexpr size_t kMaxLogPayload = 65536;

/// Reads an LCM log from its beginning to its end, once, in the order of the file. The file is not trusted:
/// memory stays below 2 MB whatever it says, and after damage reading goes on at the next event.
///
/// An event is: 0xEDA1DA01, event number (8 bytes), time (8), channel length (4), payload length (4),
/// channel, payload; big-endian. There is no checksum, so an event is believed when its lengths are sane and
/// a next one, or the end, follows it at once. When instead rubbish follows, it is still believed unless a
/// next event begins inside of it: then its lengths are wrong.
class LogReader {
 public:
  /// @throws std::runtime_error naming the file when it cannot be opened.
  explicit LogReader(const std::string& path);
  ~LogReader();
  LogReader(const LogReader&) = delete;
  LogReader& operator=(const LogReader&) = delete;

  /// The next event; nothing at the end of what the file was when it was opened.
  /// @throws std::runtime_error when the disk fails.
  std::optional<LogEvent> next();

  const LogCounts& counts() const { return counts_; }

 private:
  struct Header;
  std::span<const uint8_t> view(uint64_t offset, size_t size);
  std::optional<Header> headerAt(uint64_t offset);
  uint64_t findHeader(uint64_t from, uint64_t to);
  bool isSound(const Header& header, uint64_t end);

  std::string path_;
  int fd_;
  uint64_t size_ = 0;    // of the file
  uint64_t offset_ = 0;  // of the next event
  uint64_t buffer_offset_ = 0;
  std::vector<uint8_t> buffer_;
  LogCounts counts_;
};

}  // namespace shoal::comms
