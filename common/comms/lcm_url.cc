// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/lcm_url.h"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <charconv>
#include <cstring>
#include <stdexcept>

#include "shoal/random.h"

namespace shoal::comms {
namespace {

constexpr std::string_view kScheme = "udpm://";

[[noreturn]] void reject(std::string_view url, const std::string& why) {
  throw std::invalid_argument("LCM URL \"" + std::string(url) + "\": " + why);
}

int64_t number(std::string_view url, const std::string& name, std::string_view text, int64_t low,
               int64_t high) {
  int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < low || value > high) {
    reject(url, name + " must lie in " + std::to_string(low) + " to " + std::to_string(high) + ", got \"" +
                    std::string(text) + "\"");
  }
  return value;
}

bool isMulticast(const std::string& group) {
  in_addr address{};
  return inet_pton(AF_INET, group.c_str(), &address) == 1 && IN_MULTICAST(ntohl(address.s_addr));
}

// Binding without SO_REUSEADDR fails when anybody has the port, LCM's sockets included.
bool isFree(uint16_t port) {
  const int fd = socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  if (fd < 0) throw std::runtime_error(std::string("cannot open a UDP socket: ") + std::strerror(errno));
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_ANY);
  address.sin_port = htons(port);
  const bool bound = bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof(address)) == 0;
  close(fd);
  return bound;
}

}  // namespace

LcmUrl parseUrl(std::string_view url) {
  LcmUrl parsed;
  if (!url.starts_with(kScheme)) reject(url, "must begin with udpm://, as in " + std::string(kDefaultUrl));
  const std::string_view rest = url.substr(kScheme.size());
  const size_t question = rest.find('?');
  const std::string_view network = rest.substr(0, question);

  const size_t colon = network.find(':');
  if (colon > 0 && !network.empty()) parsed.group = std::string(network.substr(0, colon));
  if (!isMulticast(parsed.group)) {
    reject(url, "the group must be an IPv4 address from 224.0.0.0 to 239.255.255.255, got \"" + parsed.group +
                    "\"");
  }
  if (colon != std::string_view::npos) {
    parsed.port = static_cast<uint16_t>(number(url, "the port", network.substr(colon + 1), 1, 65535));
  }
  if (question == std::string_view::npos) return parsed;

  std::string_view options = rest.substr(question + 1);
  while (!options.empty()) {
    const size_t end = options.find('&');
    const std::string_view option = options.substr(0, end);
    options = end == std::string_view::npos ? std::string_view() : options.substr(end + 1);
    const size_t equals = option.find('=');
    const std::string name(option.substr(0, equals));
    const std::string_view value =
        equals == std::string_view::npos ? std::string_view() : option.substr(equals + 1);
    if (name == "ttl") {
      parsed.ttl = static_cast<int>(number(url, name, value, 0, 255));
    } else if (name == "recv_buf_size") {
      parsed.receive_buffer_bytes = number(url, name, value, 1, 1'000'000'000);
    } else {
      reject(url, "the options are ttl and recv_buf_size, got \"" + name + "\"");
    }
  }
  return parsed;
}

std::string composeUrl(const LcmUrl& url) {
  std::string text =
      std::string(kScheme) + url.group + ":" + std::to_string(url.port) + "?ttl=" + std::to_string(url.ttl);
  if (url.receive_buffer_bytes > 0) text += "&recv_buf_size=" + std::to_string(url.receive_buffer_bytes);
  return text;
}

std::string localUrl(std::string_view url) {
  LcmUrl parsed = parseUrl(url);
  parsed.ttl = 0;
  return composeUrl(parsed);
}

std::string withReceiveBuffer(std::string_view url) {
  LcmUrl parsed = parseUrl(url);
  if (parsed.receive_buffer_bytes == 0) parsed.receive_buffer_bytes = kReceiveBufferBytes;
  return composeUrl(parsed);
}

uint16_t freePort(uint64_t seed) {
  constexpr uint16_t kFirst = 20000;
  constexpr uint64_t kPorts = 40001;
  const uint64_t start = Random(seed).below(kPorts);
  for (uint64_t i = 0; i < kPorts; ++i) {
    const auto port = static_cast<uint16_t>(kFirst + (start + i) % kPorts);
    if (isFree(port)) return port;
  }
  throw std::runtime_error("no UDP port from 20000 to 60000 is free");
}

std::string chooseFreeUrl(uint64_t seed) {
  LcmUrl url;
  url.port = freePort(seed);
  return composeUrl(url);
}

}  // namespace shoal::comms
