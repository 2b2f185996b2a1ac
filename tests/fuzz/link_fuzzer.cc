// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as the file of a link: refused with a reason that names the file, or a link within its ranges.
//
//     fuzz_link -max_total_time=60 -max_len=1024
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "shoal/comms/link_model.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  try {
    check(shoal::comms::parseLink(std::string(reinterpret_cast<const char*>(data), size), "given.json"));
  } catch (const std::invalid_argument& error) {
    if (std::string(error.what()).find("given.json") == std::string::npos) std::abort();
  }
  return 0;
}
