// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include <spdlog/fmt/fmt.h>

#include "operator_console/asking.h"
#include "operator_console/command.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

struct WhyQuestion {
  Asking asking;
  std::string label;
};

std::string topicName(const Json& t) {
  return fmt::format("{}/{}", t["robot"].get<std::string>(), t["topic"].get<int>());
}

std::string likeness(const Json& t) {
  return fmt::format("{:<8} {:.3f}", topicName(t), t["similarity"].get<double>());
}

void printMembers(const Json& a) {
  fmt::print("{:<8} {:>6} {:>7} {:>7}  {:<14} {:>5}  {}\n", "topic", "cells", "words", "since s",
             "nearest member", "mean", "nearest outsider");
  for (const Json& m : a["members"]) {
    const Json& mean = m["mean_similarity"];
    const Json& outsider = m["outsider"];
    fmt::print(
        "{:<8} {:>6} {:>7} {:>7.0f}  {:<14} {:>5}  {}\n", topicName(m), m["cells"].get<int64_t>(),
        m["weight"].get<int64_t>(), m["created_s"].get<double>(),
        m["nearest"].empty() ? "-" : likeness(m["nearest"][0]),
        mean.is_null() ? "-" : fmt::format("{:.3f}", mean.get<double>()),
        outsider.is_null() ? "-" : fmt::format("{} ({})", likeness(outsider), outsider["label"].get<int>()));
  }
}

void printDecision(const Json& a) {
  const Json& near = a["nearest_label"];
  if (!near.is_null()) {
    fmt::print("most like it: label {}, {:.3f} in the mean over all pairs of topics\n",
               near["label"].get<int>(), near["mean_similarity"].get<double>());
  }
  if (a["sigma"].is_null()) {
    fmt::print("matcher {} compares nothing with sigma; similarities ({}) are for reading\n",
               a["matcher"].get<std::string>(), a["similarity"].get<std::string>());
    return;
  }
  const double sigma = a["sigma"];
  if (const Json& pairs = a["pairs"]; !pairs.is_null()) {
    fmt::print("{} >= {:.3f}: {} of {} pairs inside, {} of {} pairs with others\n",
               a["similarity"].get<std::string>(), sigma, pairs["inside_reaching_sigma"].get<int64_t>(),
               pairs["inside"].get<int64_t>(), pairs["across_reaching_sigma"].get<int64_t>(),
               pairs["across"].get<int64_t>());
  }
  if (a["margin"].is_null()) return;
  if (const Json& c = a["closest"]; !c.is_null()) {
    const Json& with = c["with"];
    fmt::print("closest call: {} and {} of label {} at {:.3f}, {:.3f} {} sigma\n", topicName(c),
               topicName(with), with["label"].get<int>(), with["similarity"].get<double>(),
               a["margin"].get<double>(), with["similarity"].get<double>() < sigma ? "below" : "above");
  } else {
    fmt::print("margin: {:.3f} from sigma ({:.3f}) to the mean with that label\n", a["margin"].get<double>(),
               sigma);
  }
}

void printWords(const Json& a) {
  for (const Json& group : a["shared_words"]) {
    std::string words;
    for (size_t i = 0; i < std::min<size_t>(3, group["words"].size()); ++i) {  // as many as fit a line
      const Json& w = group["words"][i];
      words += fmt::format("{}{} {:.1f}% ({})", words.empty() ? "" : ", ", w["word"].get<int>(),
                           100 * w["share"].get<double>(), w["members"].get<int>());
    }
    const int first = group["first"];
    fmt::print("words {}-{}: {}\n", first, first + group["size"].get<int>() - 1,
               words.empty() ? "none in common" : words);
  }
}

int why(const WhyQuestion& q) {
  const Json a = answerTo(q.asking, {{"query", "why"}, {"label", q.label}});
  if (q.asking.json) {
    std::cout << a.dump(2) << '\n';
    return 0;
  }
  const std::string name = a["name"];
  fmt::print("label {}{}: {} topic{}, {} cells; matcher {}\n", a["label"].get<int>(),
             name.empty() ? "" : " \"" + name + "\"", a["members"].size(),
             a["members"].size() == 1 ? "" : "s", a["cells"].get<int64_t>(), a["matcher"].get<std::string>());
  if (a["members"].empty()) {
    fmt::print("its topic has not been heard yet: only cells that carry it\n");
    return 0;
  }
  printMembers(a);
  printDecision(a);
  for (const Json& line : a.value("decided", Json::array()))
    fmt::print("decided: {}\n", line.get<std::string>());
  printWords(a);
  return 0;
}

}  // namespace

void addWhyCommand(CLI::App& app, Action& chosen) {
  CLI::App* command =
      app.add_subcommand("why", "why these topics are one label: what is alike, what decided");
  const auto q = std::make_shared<WhyQuestion>();
  command->add_option("label", q->label, "number of the label, or its name")->required();
  addWhere(*command, q->asking);
  command->footer(
      "A row a topic: its cells and words, the fellow most like it, its mean similarity to all fellows,\n"
      "and the topic outside the label that is most like it. Words are those that members have in common,\n"
      "with the mean share of their word group and how many members have them.\n\n"
      "  operator_console why 10004 --node state\n"
      "  operator_console why 10004 --log runs/a/mission.lcmlog --matcher hungarian");
  command->callback([q, &chosen] { chosen = [q] { return why(*q); }; });
}

}  // namespace shoal::console
