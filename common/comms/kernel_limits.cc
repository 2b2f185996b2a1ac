// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/comms/kernel_limits.h"

#include <fstream>
#include <sstream>

#include "shoal/comms/lcm_url.h"

namespace shoal::comms {

int64_t kernelReceiveLimit() {
  std::ifstream file("/proc/sys/net/core/rmem_max");
  int64_t limit = -1;
  return file >> limit ? limit : -1;
}

std::optional<std::string> receiveBufferAdvice(int64_t limit_bytes) {
  if (limit_bytes < 0 || limit_bytes >= kReceiveBufferBytes) return std::nullopt;
  return "the kernel grants receive buffers of " + std::to_string(limit_bytes) + " bytes, " +
         std::to_string(kReceiveBufferBytes) + " are needed; run: sudo sysctl -w net.core.rmem_max=4194304";
}

int64_t udpReceiveErrors() {
  std::ifstream file("/proc/net/snmp");
  std::ostringstream text;
  text << file.rdbuf();
  return udpReceiveErrors(text.str());
}

// Two lines begin with "Udp:", the first with the names, the second with the numbers.
int64_t udpReceiveErrors(const std::string& snmp) {
  std::istringstream lines(snmp);
  std::string names;
  for (std::string line; std::getline(lines, line);) {
    if (!line.starts_with("Udp: ")) continue;
    if (names.empty()) {
      names = line;
      continue;
    }
    std::istringstream name_words(names);
    std::istringstream number_words(line);
    for (std::string name, number; name_words >> name && number_words >> number;) {
      if (name == "RcvbufErrors") {
        std::istringstream parse(number);
        int64_t value = -1;
        return parse >> value ? value : -1;
      }
    }
    return -1;
  }
  return -1;
}

}  // namespace shoal::comms
