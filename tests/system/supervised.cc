// SPDX-License-Identifier: BSD-3-Clause
// A parent like launch, for supervisor_test: starts `sleep` children, says their process ids, and waits.
//
//     supervised LOG_FOLDER NUM_CHILDREN [--stubborn]      children that ignore SIGTERM
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>

#include "operator_console/stop_signal.h"
#include "operator_console/supervisor.h"

int main(int argc, char** argv) {
  using namespace shoal::console;  // NOLINT: a main file
  if (argc < 3) return 2;
  const std::string folder = argv[1];
  const bool stubborn = argc > 3 && std::strcmp(argv[3], "--stubborn") == 0;
  catchStopSignals();
  Supervisor children;
  for (int i = 0; i < std::atoi(argv[2]); ++i) {
    const std::string name = "child" + std::to_string(i);
    // An ignored signal stays ignored through exec.
    const std::string script = std::string(stubborn ? "trap '' TERM; " : "") + "echo $$; exec sleep 60";
    children.start({name, "/bin/sh", {"-c", script}, folder + "/" + name});
  }
  while (stopSignal() == 0 && children.numRunning() > 0) {
    for (const Ended& ended : children.wait(std::chrono::milliseconds(50))) {
      std::printf("%s %s\n", ended.name.c_str(), ended.how().c_str());
      std::fflush(stdout);
    }
  }
  if (stopSignal() == 0) return 1;
  children.stopAll(std::chrono::milliseconds(300));
  return 128 + stopSignal();
}
