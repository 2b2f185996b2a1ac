// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "operator_console/command.h"
#include "operator_console/doctor.h"
#include "shoal/comms/lcm_url.h"

namespace shoal::console {

void addDoctorCommand(CLI::App& app, Action& chosen) {
  struct Flags {
    std::string lcm_url = comms::kDefaultUrl, out = ".";
    bool json = false;
  };
  CLI::App* command =
      app.add_subcommand("doctor", "would a mission work on this machine? what to type when not");
  const auto flags = std::make_shared<Flags>();
  command->add_option("--lcm-url", flags->lcm_url, "multicast group of the mission")
      ->envname("SHOAL_LCM_URL")
      ->capture_default_str();
  command->add_option("--out", flags->out, "where missions are to go")->capture_default_str();
  command->add_flag("--json", flags->json, "answer in JSON");
  command->footer(
      "Exit 1 when something is bad: a mission would not work. A warning costs comfort or time.\n\n"
      "  operator_console doctor --lcm-url 'udpm://239.255.76.67:7667?ttl=1'");
  command->callback([flags, &chosen] {
    chosen = [flags] {
      const std::vector<Finding> findings = examine(flags->lcm_url, flags->out);
      std::cout << (flags->json ? toJson(findings, flags->lcm_url).dump(2) + "\n" : toText(findings));
      return works(findings) ? 0 : 1;
    };
  });
}

}  // namespace shoal::console
