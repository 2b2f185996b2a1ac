// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include <CLI/CLI.hpp>

namespace shoal::console {

/// What the chosen subcommand does once all flags have been read. Returns the exit code: 0 good, 1 failed.
/// Throws std::invalid_argument for a bad flag (exit 2), any other exception for a failure (exit 1).
using Action = std::function<int()>;

// Each adds a subcommand to `app` that sets `chosen` when it is the one. Both outlive parsing.
void addLaunchCommand(CLI::App& app, Action& chosen);
void addMatchCommand(CLI::App& app, Action& chosen);
void addPlayCommand(CLI::App& app, Action& chosen);

/// labels, at X Y, export, and status: one grammar for a running node, a finished run and a recording.
void addQuestionCommands(CLI::App& app, Action& chosen);
/// status, once or again and again.
void addStatusCommand(CLI::App& app, Action& chosen);
/// area LABEL: patches as table, CSV, GeoJSON or JSON.
void addAreaCommand(CLI::App& app, Action& chosen);
void addSurprisesCommand(CLI::App& app, Action& chosen);
/// why LABEL: what speaks for a label's topics being one.
void addWhyCommand(CLI::App& app, Action& chosen);
/// diff T1 T2: what changed on the map, from a recording.
void addDiffCommand(CLI::App& app, Action& chosen);
/// node R03: what a node has told.
void addNodeCommand(CLI::App& app, Action& chosen);
/// name, link, unlink, exclude, undo; edits, which lists them; events.
void addEditCommands(CLI::App& app, Action& chosen);
/// ask: a sharper picture from a robot, after its price.
void addAskCommand(CLI::App& app, Action& chosen);
/// score: the map as it is held, against the truth.
void addScoreCommand(CLI::App& app, Action& chosen);
/// completion SHELL: a script that completes commands and flags.
void addCompletionCommand(CLI::App& app, Action& chosen);
/// library save: names for the next mission; library show.
void addLibraryCommand(CLI::App& app, Action& chosen);
/// import BAG: a ROS 2 bag as a recording in TUM layout.
void addImportCommand(CLI::App& app, Action& chosen);
/// keygen FILE: a key for a team.
void addKeygenCommand(CLI::App& app, Action& chosen);
void addEvaluateCommand(CLI::App& app, Action& chosen);
/// summary: a finished mission as one page.
void addSummaryCommand(CLI::App& app, Action& chosen);
void addReplayCommand(CLI::App& app, Action& chosen);
/// spy: what is said on the link. doctor: would a mission work here?
void addSpyCommand(CLI::App& app, Action& chosen);
void addDoctorCommand(CLI::App& app, Action& chosen);
void addReproduceCommand(CLI::App& app, Action& chosen);
void addTuneCommand(CLI::App& app, Action& chosen);
void addVerifyCommand(CLI::App& app, Action& chosen);

/// serve: the mission as a page for browsers.
void addServeCommand(CLI::App& app, Action& chosen);

}  // namespace shoal::console
