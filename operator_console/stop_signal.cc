// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/stop_signal.h"

#include <csignal>
#include <initializer_list>

namespace shoal::console {
namespace {

volatile std::sig_atomic_t last_signal = 0;

void remember(int signal) { last_signal = signal; }

}  // namespace

void catchStopSignals() {
  struct sigaction action {};
  action.sa_handler = remember;  // no SA_RESTART: waiting ends at once
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) sigaction(signal, &action, nullptr);
  signal(SIGPIPE, SIG_IGN);
}

int stopSignal() { return last_signal; }

}  // namespace shoal::console
