// SPDX-License-Identifier: BSD-3-Clause
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>

#include <spdlog/spdlog.h>
#include <CLI/CLI.hpp>

#include "fusion_node/mission_keys.h"
#include "fusion_node/process.h"
#include "operator_console/command.h"
#include "operator_console/config_file.h"
#include "operator_console/mistake.h"
#include "shoal/version.h"

namespace {

// A full disk is an error; a reader that has enough, as head has, is none.
void checkThatAllWasSaid() {
  errno = 0;
  const bool is_said = static_cast<bool>(std::cout.flush()) && std::fflush(stdout) == 0;
  const int reason = errno;
  if (is_said && std::ferror(stdout) == 0) return;
  pollfd out{STDOUT_FILENO, POLLOUT, 0};
  if (::poll(&out, 1, 0) == 1 && (out.revents & POLLERR) != 0) return;
  throw std::runtime_error("cannot write all of the answer" +
                           (reason == 0 ? "" : std::string(": ") + std::strerror(reason)));
}

}  // namespace

int main(int argc, char** argv) {
  using namespace shoal;  // NOLINT: a main file
  CLI::App app{"Flies missions, asks about them, and scores them.", "operator_console"};
  console::Action chosen;
  std::string log_level = "info";
  app.set_version_flag("--version", std::string("operator_console ") + version() + " (" + commit() + ")");
  app.add_option("--log-level", log_level, "trace, debug, info, warn, error or off")->capture_default_str();
  app.set_config("--config", "", "mission.toml: any of these flags");
  app.config_formatter(std::make_shared<console::MissionFile>(app));
  app.allow_config_extras(
      CLI::config_extras_mode::ignore_all);  // flags of the other programs may stand there too
  app.require_subcommand(1);
  app.fallthrough();
  console::addLaunchCommand(app, chosen);
  console::addMatchCommand(app, chosen);
  console::addPlayCommand(app, chosen);
  console::addImportCommand(app, chosen);
  console::addEvaluateCommand(app, chosen);
  console::addReplayCommand(app, chosen);
  console::addVerifyCommand(app, chosen);
  console::addSummaryCommand(app, chosen);
  console::addReproduceCommand(app, chosen);
  console::addTuneCommand(app, chosen);
  console::addQuestionCommands(app, chosen);
  console::addAreaCommand(app, chosen);
  console::addSurprisesCommand(app, chosen);
  console::addWhyCommand(app, chosen);
  console::addDiffCommand(app, chosen);
  console::addNodeCommand(app, chosen);
  console::addEditCommands(app, chosen);
  console::addAskCommand(app, chosen);
  console::addScoreCommand(app, chosen);
  console::addServeCommand(app, chosen);
  console::addSpyCommand(app, chosen);
  console::addDoctorCommand(app, chosen);
  console::addLibraryCommand(app, chosen);
  console::addKeygenCommand(app, chosen);
  console::addCompletionCommand(app, chosen);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    const bool lacks = dynamic_cast<const CLI::RequiredError*>(&error) != nullptr;
    if (const std::string mistake = lacks ? console::mistakeIn(app) : ""; !mistake.empty()) {
      std::fprintf(stderr, "operator_console: %s\n", mistake.c_str());
      return 2;
    }
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    fusion_node::setUpLog("console", log_level);
    for (const std::string& typo : fusion_node::likelyTypos(app)) spdlog::warn("{}", typo);
    const int status = chosen();
    checkThatAllWasSaid();
    return status;
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "operator_console: %s\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    spdlog::error("{}", error.what());
    return 1;
  }
}
