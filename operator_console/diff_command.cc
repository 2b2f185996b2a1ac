// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/recorded_mission.h"
#include "shoal/mapping/diff_answer.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct DiffQuestion {
  Asking asking;
  std::string before, after;
  bool csv = false;
};

void printChanges(const Json& d) {
  fmt::print("from {:.1f} s to {:.1f} s: {} cells, then {}\n", d["before_s"].get<double>(),
             d["after_s"].get<double>(), d["cells_before"].get<int64_t>(), d["cells_after"].get<int64_t>());
  const auto row = [](const std::string& who, const Json& c) {
    fmt::print("{:<8} {:>9} {:>12} {:>11} {:>7}\n", who, c["appeared"].get<int64_t>(),
               c["seen"].get<int64_t>(), c["relabelled"].get<int64_t>(), c["gone"].get<int64_t>());
  };
  fmt::print("{:<8} {:>9} {:>12} {:>11} {:>7}\n", "robot", "appeared", "seen anew", "relabelled", "gone");
  for (const Json& r : d["robots"]) row(r["robot"].get<std::string>(), r);
  row("all", d["total"]);
  fmt::print("{:>9}  {:<16} {:>12} {:>12} {:>12}\n", "label", "name", "before m2", "after m2", "change m2");
  for (const Json& l : d["labels"]) {
    const double before = l["area_before_m2"], after = l["area_after_m2"];
    fmt::print("{:>9}  {:<16} {:>12.1f} {:>12.1f} {:>+12.1f}\n", l["label"].get<int>(),
               l["name"].get<std::string>(), before, after, after - before);
  }
}

int diff(const DiffQuestion& q) {
  const double before_s = parseMissionTime(q.before), after_s = parseMissionTime(q.after);
  if (before_s > after_s) {
    throw std::invalid_argument("diff goes from the earlier to the later time; got " + q.before + ", then " +
                                q.after);
  }
  const Where where = whereOf(q.asking);
  const auto viewAt = [log = recordingOf(where), matcher = matcherOf(where), key = where.key](double time_s) {
    const RecordedMission then =
        readRecording(log, matcher, {}, world::Timestamp{std::llround(time_s * 1e6)}, key);
    warnOfSeals(log, then.seals);
    return then.state.view();
  };
  const Json d = mapping::diffAnswer(viewAt(before_s), before_s, viewAt(after_s), after_s);
  if (q.asking.json) {
    std::cout << d.dump(2) << '\n';
  } else if (q.csv) {
    std::cout << mapping::diffCsv(d);
  } else {
    printChanges(d);
  }
  return 0;
}

}  // namespace

void addDiffCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("diff", "what changed on the map between two times, and by whom");
  const auto q = std::make_shared<DiffQuestion>();
  command->add_option("t1", q->before, "mission time: seconds, or 10:20, or 1:10:20")->required();
  command->add_option("t2", q->after, "a later one")->required();
  addWhere(*command, q->asking);
  command->add_flag("--csv", q->csv, "answer in CSV, a row a changed cell")
      ->excludes(command->get_option("--json"));
  command->footer(
      "Asks a recording (--log, or --run of a mission flown with --record) or what a node remembers (--node, "
      "also\n"
      "after it was started again; when it matched otherwise than usual, say how): the maps are those that a "
      "node\n"
      "held which had heard all that was sent by then. A cell has appeared, was seen anew with another "
      "label,\n"
      "was relabelled without being seen again, or is gone.\n\n"
      "  operator_console diff 0:30 1:00 --run runs/a\n"
      "  operator_console diff 30 60 --node state\n"
      "  operator_console diff 30 60 --log runs/a/mission.lcmlog --csv > changes.csv");
  command->callback([q, &chosen] { chosen = [q] { return diff(*q); }; });
}

}  // namespace shoal::console
