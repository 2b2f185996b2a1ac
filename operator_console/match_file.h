// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <iosfwd>
#include <optional>
#include <string>

namespace shoal::console {

/// What `operator_console match` was asked for. What is not given is taken from the file, then from the
/// defaults.
struct MatchFileOptions {
  std::string path;                       ///< JSON file, "-" reads `in`
  std::optional<std::string> matcher;     ///< default "clear"
  std::optional<std::string> similarity;  ///< default the usual one of the matcher
  std::optional<std::string> sigma;       ///< auto or a number in (0, 1], default auto
  bool distinct = false;                  ///< forbids merging a robot's own labels, as "shoal" does
  bool timing = false;                    ///< report the seconds that the matching took
  bool json = false;                      ///< one JSON object instead of lines of text
};

/// `operator_console match FILE.json`: matches the labels of several robots, given as word counts or as an
/// association graph.
///
///     {"counts":[2,1],"edges":[[0,2],[1,2,0.5]]}
///     {"vocabulary":100,"robots":[{"name":"R00","topics":[{"words":{"17":3}}]}],"sigma":0.75}
///
/// With "edges" the file is a graph: vertex = robot order, then label order; an edge stands for both
/// directions and has weight 1 unless it says otherwise; other keys are ignored. Otherwise it may have
/// "groups", "similarity", "sigma" and "matcher", and a topic an "id", which the matcher "id" goes by
/// (default: its place).
///
/// Writes {"universe","used","labels","sigma","matcher"}, with timing also "seconds", to `out`; "sigma" is
/// null where nothing was compared with it. Warnings and one line per error go to `err`.
///
/// @returns the exit code: 0 good, 1 the file is not readable or its content not right, 2 an option is not
/// right.
int runMatch(const MatchFileOptions& options, std::istream& in, std::ostream& out, std::ostream& err);

/// The same with "-" as standard input.
int runMatch(const MatchFileOptions& options, std::ostream& out, std::ostream& err);

}  // namespace shoal::console
