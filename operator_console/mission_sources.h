// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include <nlohmann/json_fwd.hpp>

#include "shoal/mapping/queries.h"
#include "shoal/mapping/told_surprises.h"
#include "shoal/matching/matcher.h"

namespace shoal::console {

/// Where a question goes: a running node's state folder, a finished run's folder, or a recording. One is
/// given.
struct Where {
  std::string node, run, log;
  std::string key = {};  ///< file with which a recording's seals are checked; empty: they are not
  matching::MatcherOptions matcher = matching::usualMatcher();  ///< with which a recording is fused
};

/// A finished run, from its files; when something was decided (edits.json), fused anew from the robots' own.
/// @throws std::runtime_error naming the file that is missing or broken.
mapping::MissionView viewOfRun(const std::string& dir);

/// What surprised its robots, from their own files; nothing in runs of older builds.
/// @throws std::runtime_error naming the file that is broken.
mapping::ToldSurprises surprisesOfRun(const std::string& dir, const world::Grid& grid);

/// The whole map with everything that is known, wherever it is asked of.
/// @throws std::runtime_error as viewOfRun() and readRecording(), or when no node answers.
mapping::MissionView viewOf(const Where& where);

/// Where edits of a finished mission are kept: edits.json in a run's folder, or beside a recording.
std::string editsPathOf(const Where& where);

/// How the map of a run was matched, as its summary.json says; how a node matches; else what `where` says.
/// @throws std::runtime_error when no node answers.
matching::MatcherOptions matcherOf(const Where& where);

/// What to look into for the past: --log, the mission.lcmlog of --run, or the newest file of --node.
/// @throws std::runtime_error when there is none: a run that was not recorded, a node that has heard nothing.
std::string recordingOf(const Where& where);

/// Answers any question of mapping/questions.h from wherever, and makes the edits of mapping/edit_question.h.
/// What cannot be answered comes back as
/// {"error": ...}. The matcher is matcherOf(where).
nlohmann::ordered_json ask(const Where& where, const nlohmann::ordered_json& question);

}  // namespace shoal::console
