// SPDX-License-Identifier: BSD-3-Clause
// Any bytes as mission.toml: flags are set, or it is refused as a wrong flag is.
//
//     fuzz_mission_file -max_total_time=60 -max_len=1024
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>

#include "file_in_memory.h"
#include "operator_console/config_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  static FileInMemory file;
  file.write(data, size);
  CLI::App app{"", "operator_console"};
  app.set_config("--config");
  app.config_formatter(std::make_shared<shoal::console::MissionFile>(app));
  app.allow_config_extras(CLI::config_extras_mode::ignore_all);
  app.require_subcommand(1);
  app.fallthrough();
  std::string world = "reef:sparse";
  int robots = 12;
  bool single = false;
  CLI::App* launch = app.add_subcommand("launch");
  launch->add_option("--world", world);
  launch->add_option("--robots", robots)->check(CLI::Range(1, 100));
  launch->add_flag("--single", single);
  try {
    app.parse("launch --config " + file.path());
    if (robots < 1 || robots > 100) std::abort();
  } catch (const CLI::ParseError& error) {
    if (std::string(error.what()).empty()) std::abort();
  }
  return 0;
}
