// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/mapping/label_name.h"

#include <cstdint>

namespace shoal::mapping {

bool isLabelName(std::string_view text) {
  if (text.size() > kMaxLabelNameBytes) return false;
  for (size_t i = 0; i < text.size();) {
    const auto lead = static_cast<uint8_t>(text[i]);
    const size_t length = lead < 0x80   ? 1
                          : lead < 0xc2 ? 0
                          : lead < 0xe0 ? 2
                          : lead < 0xf0 ? 3
                          : lead < 0xf5 ? 4
                                        : 0;
    if (length == 0 || i + length > text.size()) return false;
    uint32_t point = length == 1 ? lead : lead & (0x7fu >> length);
    for (size_t k = 1; k < length; ++k) {
      const auto next = static_cast<uint8_t>(text[i + k]);
      if ((next & 0xc0) != 0x80) return false;
      point = point << 6 | (next & 0x3fu);
    }
    if (length == 3 && (point < 0x800 || (point >= 0xd800 && point < 0xe000)))
      return false;  // overlong, surrogate
    if (length == 4 && (point < 0x10000 || point > 0x10ffff)) return false;
    if (point < 0x20 || (point >= 0x7f && point < 0xa0)) return false;  // control characters
    i += length;
  }
  return true;
}

}  // namespace shoal::mapping
