// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace shoal::console {

/// After `app` has refused a command line because something is missing: the word in it that is no command,
/// or no option of the command, and what may have been meant. Empty when there is no such word.
std::string mistakeIn(const CLI::App& app);

}  // namespace shoal::console
