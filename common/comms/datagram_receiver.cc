// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/datagram_receiver.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shoal/comms/channels.h"
#include "shoal/demand.h"

namespace shoal::comms {
namespace {

constexpr std::array<uint8_t, 4> kMagic = {'L', 'C', '0', '2'};
constexpr size_t kHeaderBytes = 8;
constexpr size_t kLargestDatagram = 65536;
constexpr std::string_view kOurs = "SHOAL_";

// A socket that hears the group as LCM's own does; -1 with errno when the kernel refuses.
int openSocket(const LcmUrl& url) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  if (fd < 0) return -1;
  const int yes = 1, no = 0;
  const auto buffer = static_cast<int>(url.receive_buffer_bytes);
  sockaddr_in here{};
  here.sin_family = AF_INET;
  here.sin_port = htons(url.port);
  ip_mreq group{};
  const bool works = inet_pton(AF_INET, url.group.c_str(), &group.imr_multiaddr) == 1 &&
                     setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes) == 0 &&
                     (buffer == 0 || setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &buffer, sizeof buffer) == 0) &&
                     setsockopt(fd, IPPROTO_IP, IP_MULTICAST_ALL, &no, sizeof no) == 0 &&
                     bind(fd, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0 &&
                     setsockopt(fd, IPPROTO_IP, IP_ADD_MEMBERSHIP, &group, sizeof group) == 0;
  if (works) return fd;
  const int why = errno;
  close(fd);
  errno = why;
  return -1;
}

void signal(int event) {
  const uint64_t one = 1;
  SHOAL_DEMAND(write(event, &one, sizeof one) == sizeof one);
}

}  // namespace

DatagramReceiver::DatagramReceiver(const LcmUrl& url, size_t max_queue) : max_queue_(max_queue) {
  socket_ = openSocket(url);
  if (socket_ < 0)
    throw std::runtime_error(std::string("the group cannot be joined: ") + std::strerror(errno));
  ready_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  stop_ = eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK);
  SHOAL_DEMAND(ready_ >= 0 && stop_ >= 0);
  thread_ = std::thread([this] { run(); });
}

DatagramReceiver::~DatagramReceiver() {
  signal(stop_);
  thread_.join();
  for (const int fd : {socket_, ready_, stop_}) close(fd);
}

std::deque<Packet> DatagramReceiver::take() {
  const std::lock_guard lock(mutex_);
  uint64_t told = 0;
  if (read(ready_, &told, sizeof told) < 0) SHOAL_DEMAND(errno == EAGAIN);
  return std::exchange(queue_, {});
}

DatagramCounts DatagramReceiver::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

void DatagramReceiver::run() {
  std::vector<uint8_t> bytes(kLargestDatagram);
  std::array<pollfd, 2> events{{{socket_, POLLIN, 0}, {stop_, POLLIN, 0}}};
  while (true) {
    if (poll(events.data(), events.size(), -1) < 0) continue;  // a signal
    if (events[1].revents != 0) return;
    const ssize_t size = recv(socket_, bytes.data(), bytes.size(), 0);
    if (size > 0) hear(bytes.data(), static_cast<size_t>(size));
  }
}

// Nothing is read before the sizes are known to be sound, and nothing thrown may leave the thread.
void DatagramReceiver::hear(const uint8_t* bytes, size_t size) {
  if (size <= kHeaderBytes || !std::equal(kMagic.begin(), kMagic.end(), bytes)) return;
  const uint8_t* channel = bytes + kHeaderBytes;
  const size_t most = std::min(size - kHeaderBytes, kMaxChannelLength + 1);
  const auto* end = static_cast<const uint8_t*>(std::memchr(channel, 0, most));
  if (end == nullptr) return;
  const std::string_view name(reinterpret_cast<const char*>(channel), static_cast<size_t>(end - channel));
  if (!name.starts_with(kOurs)) return;
  const std::lock_guard lock(mutex_);
  if (size > kMaxMessageBytes) {
    ++counts_.bad_size;
    return;
  }
  if (queue_.size() >= max_queue_) {
    ++counts_.dropped;
    return;
  }
  try {
    if (!parseChannel(name)) {
      ++counts_.bad_channel;
      return;
    }
    queue_.push_back({std::string(name), Bytes(end + 1, bytes + size)});
  } catch (...) {  // no memory
    ++counts_.dropped;
    return;
  }
  if (queue_.size() == 1) signal(ready_);
}

}  // namespace shoal::comms
