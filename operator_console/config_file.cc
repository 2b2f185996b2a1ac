// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/config_file.h"

namespace shoal::console {

std::vector<CLI::ConfigItem> MissionFile::from_config(std::istream& input) const {
  std::vector<CLI::ConfigItem> read = CLI::ConfigTOML::from_config(input);
  const auto chosen = app_.get_subcommands();
  if (chosen.empty()) return read;
  const CLI::App& command = *chosen.front();
  for (CLI::ConfigItem& item : read) {
    const bool is_section_mark = item.name == "++" || item.name == "--";
    if (item.parents.empty() && !is_section_mark && command.get_option_no_throw("--" + item.name)) {
      item.parents = {command.get_name()};
    }
  }
  return read;
}

}  // namespace shoal::console
