// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <string>

namespace shoal::comms {

/// The largest receive buffer that the kernel grants (net.core.rmem_max), bytes; -1 when it cannot be read.
/// Above it a request is silently clamped.
int64_t kernelReceiveLimit();

/// The command that helps when `limit_bytes` is below what our processes ask for; nothing when it is enough
/// or unknown.
std::optional<std::string> receiveBufferAdvice(int64_t limit_bytes = kernelReceiveLimit());

/// Datagrams the kernel dropped because a receive buffer was full, since boot, all sockets of this network
/// namespace (Udp RcvbufErrors in /proc/net/snmp); -1 when it cannot be read.
int64_t udpReceiveErrors();

/// The same, from the text of /proc/net/snmp.
int64_t udpReceiveErrors(const std::string& snmp);

}  // namespace shoal::comms
