// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>

namespace shoal::console {

/// Reads mission.toml for a program with subcommands: what stands in no section belongs to the subcommand
/// that was chosen, so that the same file serves robot_agent, fusion_node and every subcommand.
class MissionFile : public CLI::ConfigTOML {
 public:
  explicit MissionFile(const CLI::App& app) : app_(app) {}
  std::vector<CLI::ConfigItem> from_config(std::istream& input) const override;

 private:
  const CLI::App& app_;
};

}  // namespace shoal::console
