// SPDX-License-Identifier: BSD-3-Clause
// write_golden_wire FOLDER: writes the golden messages. Only for a type or example that is new: what is
// released never changes (docs/wire.md).
#include <cstdio>
#include <fstream>

#include "examples.h"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fprintf(stderr, "usage: write_golden_wire FOLDER\n");
    return 2;
  }
  for (const auto& example : shoal::wire::goldenExamples()) {
    const std::string path = std::string(argv[1]) + "/" + example.name + ".bin";
    std::ofstream file(path, std::ios::binary);
    file.write(reinterpret_cast<const char*>(example.bytes.data()),
               static_cast<std::streamsize>(example.bytes.size()));
    if (!file) {
      std::fprintf(stderr, "cannot write %s\n", path.c_str());
      return 1;
    }
  }
  return 0;
}
