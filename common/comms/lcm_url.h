// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace shoal::comms {

inline constexpr const char* kDefaultUrl = "udpm://239.255.76.67:7667?ttl=0";

/// What our processes ask of the kernel unless the URL says otherwise: bursts need it.
inline constexpr int64_t kReceiveBufferBytes = 2'097'152;

/// A multicast group as LCM writes it: udpm://group:port?ttl=N&recv_buf_size=M.
struct LcmUrl {
  std::string group = "239.255.76.67";  ///< IPv4, 224.0.0.0 to 239.255.255.255.
  uint16_t port = 7667;                 ///< >= 1.
  int ttl = 0;                          ///< 0 to 255; 0 = this host only, 1 = this network.
  int64_t receive_buffer_bytes = 0;     ///< 0 = not said.

  friend bool operator==(const LcmUrl&, const LcmUrl&) = default;
};

/// Group, port and options may be left out, as in LCM.
/// @throws std::invalid_argument naming the part that is wrong.
LcmUrl parseUrl(std::string_view url);

/// The inverse of parseUrl(); ttl is always there.
std::string composeUrl(const LcmUrl& url);

/// The same group for this host alone: with ttl=0.
/// @throws std::invalid_argument as parseUrl().
std::string localUrl(std::string_view url);

/// The same with recv_buf_size=2097152 where it says nothing.
/// @throws std::invalid_argument as parseUrl().
std::string withReceiveBuffer(std::string_view url);

/// A UDP port in 20000 to 60000 that nobody on this host has bound, in any network interface; which one is a
/// function of the seed and of what is taken. Somebody else may take it before the caller does.
/// @throws std::runtime_error when sockets cannot be had.
uint16_t freePort(uint64_t seed);

/// The default group, ttl=0, on freePort(seed).
std::string chooseFreeUrl(uint64_t seed);

}  // namespace shoal::comms
