// SPDX-License-Identifier: BSD-3-Clause
// Any text as a library file: it is refused with a runtime_error, or read, and then written and read again
// the same.
//
//     fuzz_library -max_total_time=60 $(mktemp -d) tests/fuzz/corpus/library
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "shoal/mapping/library.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace shoal::mapping;  // NOLINT: a harness
  Library library;
  try {
    library = parseLibrary(std::string(reinterpret_cast<const char*>(data), size), "a.library");
  } catch (const std::runtime_error&) {
    return 0;
  }
  if (parseLibrary(libraryJson(library), "a.library") != library) std::abort();
  return 0;
}
