// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/log_writer.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <stdexcept>

namespace shoal::comms {
namespace {

constexpr uint64_t kSyncWord = 0xEDA1DA01u;

void put(Bytes& out, uint64_t value, int num_bytes) {
  for (int i = num_bytes - 1; i >= 0; --i) out.push_back(static_cast<uint8_t>(value >> (8 * i)));
}

}  // namespace

void appendLogEvent(Bytes& out, const Packet& packet, uint64_t number, int64_t time_us) {
  put(out, kSyncWord, 4);
  put(out, number, 8);
  put(out, static_cast<uint64_t>(time_us), 8);
  put(out, packet.channel.size(), 4);
  put(out, packet.bytes.size(), 4);
  out.insert(out.end(), packet.channel.begin(), packet.channel.end());
  out.insert(out.end(), packet.bytes.begin(), packet.bytes.end());
}

LogWriter::LogWriter(const std::string& path) : path_(path) {
  const auto folder = std::filesystem::path(path).parent_path();
  std::error_code error;
  if (!folder.empty()) std::filesystem::create_directories(folder, error);
  fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0644);
  if (fd_ < 0) throw std::runtime_error("cannot write " + path + ": " + std::strerror(errno));
  struct stat about {};
  if (::fstat(fd_, &about) == 0) bytes_ = static_cast<uint64_t>(about.st_size);
}

LogWriter::~LogWriter() { ::close(fd_); }

void LogWriter::append(const Packet& packet, int64_t time_us) {
  Bytes event;
  appendLogEvent(event, packet, num_appended_++, time_us);
  size_t written = 0;
  while (written < event.size()) {
    const ssize_t n = ::write(fd_, event.data() + written, event.size() - written);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) throw std::runtime_error("cannot write " + path_ + ": " + std::strerror(errno));
    written += static_cast<size_t>(n);
  }
  bytes_ += event.size();
}

}  // namespace shoal::comms
