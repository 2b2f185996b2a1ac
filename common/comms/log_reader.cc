// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/log_reader.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <utility>

#include "shoal/comms/channels.h"

namespace shoal::comms {
namespace {

constexpr std::array<uint8_t, 4> kSync = {0xED, 0xA1, 0xDA, 0x01};
constexpr size_t kEventHeaderBytes = 28;
constexpr size_t kBufferBytes = size_t{1} << 18;
constexpr size_t kSearchStep = size_t{1} << 16;

uint64_t bigEndian(std::span<const uint8_t> bytes) {
  uint64_t value = 0;
  for (const uint8_t byte : bytes) value = value << 8 | byte;
  return value;
}

}  // namespace

struct LogReader::Header {
  int64_t time_us;
  uint64_t channel_length;
  uint64_t payload_length;

  uint64_t total() const { return kEventHeaderBytes + channel_length + payload_length; }
};

LogReader::LogReader(const std::string& path) : path_(path), fd_(open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  struct stat status {};
  if (fd_ < 0 || fstat(fd_, &status) != 0 || !S_ISREG(status.st_mode)) {
    const std::string why = fd_ < 0 ? std::strerror(errno) : "not a file";
    if (fd_ >= 0) close(fd_);
    throw std::runtime_error("cannot read the log " + path + ": " + why);
  }
  size_ = static_cast<uint64_t>(status.st_size);
}

LogReader::~LogReader() { close(fd_); }

std::optional<LogEvent> LogReader::next() {
  while (offset_ < size_) {
    const auto header = headerAt(offset_);
    const uint64_t end = header ? offset_ + header->total() : size_;
    if (!header || !isSound(*header, end)) {
      const uint64_t found = findHeader(offset_ + 1, end);
      ++counts_.damaged;
      counts_.damaged_bytes += found - offset_;
      offset_ = found;
      continue;
    }
    const uint64_t start = std::exchange(offset_, end);
    if (header->payload_length > kMaxLogPayload) {
      ++counts_.large;
      continue;
    }
    const auto event = view(start, header->total());
    if (event.size() < header->total()) break;  // the file was cut while being read
    const auto channel = event.subspan(kEventHeaderBytes, header->channel_length);
    const auto payload = event.subspan(kEventHeaderBytes + header->channel_length);
    ++counts_.good;
    return LogEvent{header->time_us, Packet{std::string(channel.begin(), channel.end()),
                                            Bytes(payload.begin(), payload.end())}};
  }
  offset_ = size_;
  return std::nullopt;
}

// A next event, or the end, follows; or rubbish does, but no next event begins inside.
bool LogReader::isSound(const Header& header, uint64_t end) {
  return end == size_ || headerAt(end) || findHeader(end - header.total() + 1, end) == end;
}

// Up to `size` bytes at `offset`, fewer at the end of the file. Valid until the next call.
std::span<const uint8_t> LogReader::view(uint64_t offset, size_t size) {
  if (offset < buffer_offset_ || offset + size > buffer_offset_ + buffer_.size()) {
    buffer_offset_ = offset;
    buffer_.resize(kBufferBytes);
    size_t filled = 0;
    while (filled < buffer_.size()) {
      const ssize_t got =
          pread(fd_, buffer_.data() + filled, buffer_.size() - filled, static_cast<off_t>(offset + filled));
      if (got < 0 && errno == EINTR) continue;
      if (got < 0) throw std::runtime_error("cannot read the log " + path_ + ": " + std::strerror(errno));
      if (got == 0) break;
      filled += static_cast<size_t>(got);
    }
    buffer_.resize(filled);
  }
  const std::span<const uint8_t> rest = std::span(buffer_).subspan(offset - buffer_offset_);
  return rest.first(std::min(size, rest.size()));
}

// The header at `offset`, when there is one with sane lengths and the file holds all of its event.
std::optional<LogReader::Header> LogReader::headerAt(uint64_t offset) {
  const auto bytes = view(offset, kEventHeaderBytes);
  if (bytes.size() < kEventHeaderBytes || !std::ranges::equal(bytes.first(4), kSync)) return std::nullopt;
  const Header header{static_cast<int64_t>(bigEndian(bytes.subspan(12, 8))), bigEndian(bytes.subspan(20, 4)),
                      bigEndian(bytes.subspan(24, 4))};
  if (header.channel_length < 1 || header.channel_length > kMaxChannelLength) return std::nullopt;
  if (header.payload_length > std::numeric_limits<int32_t>::max()) return std::nullopt;
  if (header.total() > size_ - offset) return std::nullopt;
  return header;
}

// The first header in [from, to), else `to`.
uint64_t LogReader::findHeader(uint64_t from, uint64_t to) {
  while (from < to) {
    const auto bytes = view(from, kSearchStep);
    if (bytes.size() < kEventHeaderBytes) return to;
    const auto sync = std::search(bytes.begin(), bytes.end(), kSync.begin(), kSync.end());
    if (sync == bytes.end()) {
      from += bytes.size() - (kSync.size() - 1);
      continue;
    }
    from += static_cast<uint64_t>(sync - bytes.begin());
    if (from >= to) return to;
    if (headerAt(from)) return from;
    ++from;
  }
  return to;
}

}  // namespace shoal::comms
