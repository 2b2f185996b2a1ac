// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as an LCM log: reading ends, and every byte is in an event or counted as damage. The first byte
// says how often a sync word is put in, so that the fuzzer finds events at once.
//
//     fuzz_log -max_total_time=60 -max_len=4096
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "file_in_memory.h"
#include "shoal/comms/channels.h"
#include "shoal/comms/log_reader.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static FileInMemory file;
  if (size == 0) return 0;
  std::vector<uint8_t> log(data + 1, data + size);
  constexpr std::array<uint8_t, 4> kSync = {0xED, 0xA1, 0xDA, 0x01};
  if (const size_t step = data[0]; step >= 28) {
    for (size_t at = 0; at + 28 <= log.size(); at += step) {
      std::ranges::copy(kSync, log.begin() + static_cast<std::ptrdiff_t>(at));
      std::fill_n(log.begin() + static_cast<std::ptrdiff_t>(at) + 20, 3, uint8_t{0});  // short lengths
      std::fill_n(log.begin() + static_cast<std::ptrdiff_t>(at) + 24, 3, uint8_t{0});
    }
  }
  file.write(log.data(), log.size());
  shoal::comms::LogReader reader(file.path());
  size_t delivered = 0;
  while (const auto event = reader.next()) {
    const size_t letters = event->packet.channel.size();
    if (letters < 1 || letters > shoal::comms::kMaxChannelLength) std::abort();
    delivered += 28 + letters + event->packet.bytes.size();
  }
  if (delivered + reader.counts().damaged_bytes != log.size()) std::abort();
  return 0;
}
