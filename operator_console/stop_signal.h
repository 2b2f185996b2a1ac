// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace shoal::console {

/// From now on SIGINT, SIGTERM and SIGHUP only leave a note, and a reader that went away is an error of
/// writing, not a signal.
void catchStopSignals();

/// The last such signal; 0 while there was none.
int stopSignal();

}  // namespace shoal::console
