// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace shoal::console {

/// A script for bash that completes the commands of `app`, their flags, and the values of --matcher and
/// --similarity; where none of these can stand, files. To be sourced.
std::string bashCompletion(const CLI::App& app);

/// The same for zsh, with descriptions. To be sourced, or put into a folder of $fpath as `_operator_console`.
std::string zshCompletion(const CLI::App& app);

}  // namespace shoal::console
