// SPDX-License-Identifier: BSD-3-Clause
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"
#include "operator_console/terminal.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct Judging {
  Asking asking;
  std::string label, text, a, b, robot, which;
};

int decide(const Judging& q, Json question) {
  const Json a = answerTo(q.asking, question);
  if (q.asking.json) {
    std::cout << a.dump(2) << '\n';
  } else {
    fmt::print("{}: {}\n", a["id"].get<std::string>(), a["says"].get<std::string>());
  }
  return 0;
}

int edits(const Judging& q) {
  const Json a = answerTo(q.asking, {{"query", "edits"}});
  if (q.asking.json) {
    std::cout << a.dump(2) << '\n';
    return 0;
  }
  if (a["edits"].empty()) fmt::print("nothing has been decided\n");
  for (const Json& e : a["edits"]) {
    fmt::print("{:<14} {:>9.1f} s  {:<10} {}\n", e["id"].get<std::string>(), e["time_s"].get<double>(),
               e["standing"].get<std::string>(), lastColumn(e["says"].get<std::string>(), 42));
  }
  return 0;
}

int events(const Judging& q, const std::string& kind) {
  Json a = answerTo(q.asking, {{"query", "events"}});
  if (!kind.empty()) {
    Json chosen = Json::array();
    for (Json& e : a["events"])
      if (e["kind"] == kind) chosen.push_back(std::move(e));
    a["events"] = std::move(chosen);
  }
  if (q.asking.json) {
    std::cout << a.dump(2) << '\n';
    return 0;
  }
  if (a["events"].empty()) fmt::print("nothing happened\n");
  for (const Json& e : a["events"]) {
    fmt::print("{:>9.1f} s  {:<8} {} {}\n", e["at_s"].get<double>(), e["kind"].get<std::string>(),
               column(e["node"].get<std::string>(), 17), lastColumn(e["says"].get<std::string>(), 39));
  }
  return 0;
}

constexpr const char* kWhere =
    "With --node all nodes of the mission get to know it, and fuse with it. With --run or --log it is kept "
    "in\n"
    "edits.json beside the mission's files, and every later answer has it.\n\n";

}  // namespace

void addEditCommands(CLI::App& app, Action& chosen) {
  const auto add = [&app](const char* name, const char* what, const std::string& footer) {
    CLI::App* command = app.add_subcommand(name, what);
    const auto q = std::make_shared<Judging>();
    addWhere(*command, q->asking);
    command->footer(kWhere + footer);
    return std::pair(command, q);
  };
  const auto act = [&chosen](CLI::App* command, const std::shared_ptr<Judging>& q,
                             const std::function<Json(const Judging&)>& question) {
    command->callback(
        [q, question, &chosen] { chosen = [q, question] { return decide(*q, question(*q)); }; });
  };
  const char* labels = "number or name of a label, or the number of one of its topics";

  const auto [name, named] =
      add("name", "call a label something",
          "The name sticks to the topic that the label is named after, and to whatever label\n"
          "holds that topic. Of several names the newest counts; \"\" takes it away.\n\n"
          "  operator_console name 10004 \"brain coral\" --node state");
  name->add_option("label", named->label, labels)->required();
  name->add_option("text", named->text, "what to call it, at most 64 bytes")->required();
  act(name, named, [](const Judging& q) {
    return Json{{"edit", "name"}, {"label", q.label}, {"text", q.text}};
  });

  for (const bool apart : {false, true}) {
    const auto [link, linked] =
        add(apart ? "unlink" : "link",
            apart ? "two topics are not the same thing" : "two labels are the same thing",
            apart ? "  operator_console unlink 10004 20003 --node state"
                  : "  operator_console link 10004 20003 --node state");
    link->add_option("a", linked->a, labels)->required();
    link->add_option("b", linked->b, labels)->required();
    act(link, linked, [apart](const Judging& q) {
      return Json{{"edit", apart ? "unlink" : "link"}, {"a", q.a}, {"b", q.b}};
    });
  }

  const auto [exclude, excluded] = add("exclude", "make the map as if a robot had never been there",
                                       "  operator_console exclude R07 --node state");
  exclude->add_option("robot", excluded->robot, "R07")->required();
  act(exclude, excluded, [](const Judging& q) { return Json{{"edit", "exclude"}, {"robot", q.robot}}; });

  const auto [undo, undone] =
      add("undo", "take back what was decided",
          "Without EDIT the newest of whom is asked that is in force. An undo can be undone.\n\n"
          "  operator_console undo --node state\n"
          "  operator_console undo OPERATOR/3 --node state\n"
          "  operator_console undo CONSOLE/1 --run runs/a");
  undo->add_option("edit", undone->which,
                   "OPERATOR/3, as edits lists them; what was decided with --run or --log is CONSOLE's");
  act(undo, undone, [](const Judging& q) {
    Json question{{"edit", "undo"}};
    if (!q.which.empty()) question["which"] = q.which;
    return question;
  });

  const auto [list, asked] = add("edits", "what was decided, by whom and when, and whether it is in force",
                                 "  operator_console edits --run runs/a");
  list->callback([q = asked, &chosen] { chosen = [q] { return edits(*q); }; });

  CLI::App* happened =
      app.add_subcommand("events", "what happened: who joined, landed, was lost; labels, edits, refusals");
  const auto q = std::make_shared<Judging>();
  const auto kind = std::make_shared<std::string>();
  addWhere(*happened, q->asking);
  happened->add_option("--kind", *kind, "only these")
      ->check(CLI::IsMember({"joined", "landed", "looked", "leaving", "again", "lost", "back", "twin",
                             "refused", "mission", "label", "edit"}));
  happened->footer(
      "Labels stand at the time when their oldest topic was opened. A run that was flown without --record "
      "knows\n"
      "labels and edits only. refused is told at the 1st, 10th, 100th message.\n\n"
      "  operator_console events --node state --kind lost");
  happened->callback([q, kind, &chosen] { chosen = [q, kind] { return events(*q, *kind); }; });
}

}  // namespace shoal::console
