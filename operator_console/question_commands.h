// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace CLI {
class App;
}

namespace shoal::console {

/// status, labels, at X Y, export: one grammar for a running node, a finished run and a recording.
void addQuestionCommands(CLI::App& app);

}  // namespace shoal::console
