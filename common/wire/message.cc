// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/message.h"

#include <stdexcept>
#include <string>

namespace shoal::wire {

Bytes checkedSize(Bytes bytes, const char* what) {
  if (bytes.size() <= kMaxMessageBytes) return bytes;
  throw std::invalid_argument(std::string(what) + " takes " + std::to_string(bytes.size()) +
                              " bytes, a message at most " + std::to_string(kMaxMessageBytes) +
                              ": cut it to fit first");
}

}  // namespace shoal::wire
