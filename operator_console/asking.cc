// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/asking.h"

#include <charconv>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "fusion_node/process.h"

namespace shoal::console {

using Json = nlohmann::ordered_json;

void addWhere(CLI::App& command, Asking& asking) {
  auto* where = command.add_option_group("where", "whom to ask: exactly one");
  where->add_option("--node", asking.where.node, "state folder of a running fusion_node");
  where->add_option("--run", asking.where.run, "folder of a finished mission");
  where->add_option("--log", asking.where.log,
                    "a recording made by lcm-logger, or what a node remembers (mission-*.sqlite)");
  where->require_option(1);
  command
      .add_option("--matcher", asking.where.matcher.matcher,
                  "for --log: id, hungarian, incremental, components, clear or shoal")
      ->capture_default_str();
  command.add_option("--similarity", asking.similarity,
                     "for --log: cosine, overlap, l1, l2, hellinger, js or discounted");
  command
      .add_option("--sigma", asking.sigma,
                  "for --log: least similarity of a match: auto or a number in (0, 1]")
      ->capture_default_str();
  command.add_option("--key", asking.where.key, "for --log: the team's key file, to check the seals");
  command.add_flag("--json", asking.json, "answer in JSON");
}

Where whereOf(const Asking& asking) {
  Where where = asking.where;
  where.matcher.sigma = matching::parseSigma(asking.sigma);
  where.matcher.similarity =
      asking.similarity.empty() ? matching::usualSimilarity(where.matcher.matcher) : asking.similarity;
  matching::match(matching::DescriptorSet{},
                  where.matcher);  // an unknown one is refused, also where none is needed
  return where;
}

Json answerTo(const Asking& asking, const Json& question) {
  Json answer = ask(whereOf(asking), question);
  if (answer.contains("error")) throw std::runtime_error(answer.at("error").get<std::string>());
  return answer;
}

std::string joined(const Json& list, const std::string& separator) {
  std::string text;
  for (const Json& item : list) text += (text.empty() ? "" : separator) + item.get<std::string>();
  return text;
}

double parseMissionTime(const std::string& text) {
  const auto refuse = [&text]() -> double {
    throw std::invalid_argument("\"" + text +
                                "\" is no mission time; seconds (620), minutes:seconds (10:20) or "
                                "hours:minutes:seconds (1:10:20) are");
  };
  double seconds = 0;
  size_t begin = 0;
  for (int fields = 1;; ++fields) {
    const size_t colon = text.find(':', begin);
    const bool is_last = colon == std::string::npos;
    const char* first = text.data() + begin;
    const char* last = text.data() + (is_last ? text.size() : colon);
    double value = 0;
    const auto [end, error] = std::from_chars(first, last, value, std::chars_format::fixed);
    const bool is_sub = fields > 1;  // minutes and seconds stay below 60
    if (error != std::errc{} || end != last || !(value >= 0) || value > 4e12 || (is_sub && value >= 60) ||
        (!is_last && value != static_cast<double>(static_cast<int64_t>(value)))) {
      return refuse();
    }
    seconds = seconds * 60 + value;
    if (is_last) return seconds;
    if (fields == 3) return refuse();
    begin = colon + 1;
  }
}

}  // namespace shoal::console
