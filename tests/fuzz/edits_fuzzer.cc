// SPDX-License-Identifier: BSD-3-Clause
// Any text as edits.json: it is refused with a runtime_error, or read, and then written and read again the
// same.
//
//     fuzz_edits -max_total_time=60 $(mktemp -d) tests/fuzz/corpus/edits
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "shoal/mapping/edits_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace shoal::mapping;  // NOLINT: a harness
  EditsFile file;
  try {
    file = parseEdits(std::string(reinterpret_cast<const char*>(data), size), "edits.json");
  } catch (const std::runtime_error&) {
    return 0;
  }
  const EditsFile again = parseEdits(editsJson(file.mission, file.edits), "edits.json");
  if (again.mission != file.mission || again.edits != file.edits) std::abort();
  return 0;
}
