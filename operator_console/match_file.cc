// SPDX-License-Identifier: BSD-3-Clause
#include "match_file.h"

#include <chrono>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "match_input.h"
#include "shoal/matching/matcher.h"

namespace shoal::console {
namespace {

// What the flags say, over what the file says (nothing yet in `file`), over the defaults.
matching::MatcherOptions chosen(const MatchFileOptions& flags, const MatchInput& file) {
  matching::MatcherOptions options;
  options.matcher = flags.matcher.value_or(file.matcher.value_or("clear"));
  const std::string usual = matching::usualSimilarity(options.matcher);
  options.similarity = flags.similarity.value_or(file.similarity.value_or(usual));
  options.sigma = flags.sigma ? matching::parseSigma(*flags.sigma) : file.sigma;
  if (flags.distinct) options.distinct = true;
  return options;
}

struct Result {
  matching::Clustering clustering;
  std::optional<double> sigma;  // where it decided
  std::string matcher;
  double seconds = 0.0;
};

void writeJson(const Result& result, bool timing, std::ostream& out) {
  nlohmann::ordered_json json;
  json["universe"] = result.clustering.universe;
  json["used"] = result.clustering.num_labels;
  json["labels"] = result.clustering.label;
  json["sigma"] = result.sigma ? nlohmann::ordered_json(*result.sigma) : nlohmann::ordered_json(nullptr);
  json["matcher"] = result.matcher;
  if (timing) json["seconds"] = result.seconds;
  out << json.dump() << '\n';
}

void writeText(const Result& result, const MatchInput& input, bool timing, std::ostream& out) {
  out << result.matcher << ": " << result.clustering.num_labels << " labels in use of "
      << result.clustering.universe << '\n';
  size_t vertex = 0;
  for (size_t r = 0; r < input.names.size(); ++r) {
    out << input.names[r] << ':';
    for (int k = 0; k < input.num_labels[r]; ++k) out << ' ' << result.clustering.label[vertex++];
    out << '\n';
  }
  if (timing) out << "matched in " << result.seconds << " s\n";
}

Result timedMatch(const MatchInput& input, const matching::MatcherOptions& options) {
  Result result;
  result.matcher = options.matcher;
  const auto start = std::chrono::steady_clock::now();
  result.clustering =
      std::visit([&](const auto& labels) { return matching::match(labels, options); }, input.labels);
  result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  const bool compared = std::holds_alternative<matching::DescriptorSet>(input.labels);
  if (compared && matching::usesSigma(options.matcher)) result.sigma = options.leastSimilarity();
  return result;
}

}  // namespace

int runMatch(const MatchFileOptions& flags, std::istream& in, std::ostream& out, std::ostream& err) {
  const auto failed = [&err](const std::string& what, int code) {
    err << "match: " << what << '\n';
    return code;
  };
  try {
    matching::check(chosen(flags, {}));
  } catch (const std::invalid_argument& e) {
    return failed(e.what(), 2);
  }
  try {
    std::ifstream file;
    if (flags.path != "-") {
      file.open(flags.path, std::ios::binary);
      if (!file || file.peek() == std::ifstream::traits_type::eof()) {
        return failed("cannot read \"" + flags.path + "\", or it is empty; a JSON file would be right", 1);
      }
    }
    const MatchInput input = readMatchInput(flags.path == "-" ? in : file);
    for (const std::string& warning : input.warnings) err << "match: warning: " << warning << '\n';

    const matching::MatcherOptions options = chosen(flags, input);
    if (std::holds_alternative<matching::AssociationGraph>(input.labels)) {
      if (flags.similarity || flags.sigma) {
        err << "match: warning: the edges are given, so --similarity and --sigma decide nothing\n";
      }
      if (options.matcher != "clear" && options.matcher != "components") {
        return failed("matcher \"" + options.matcher + "\" compares word counts, but \"" + flags.path +
                          "\" is a graph; \"clear\" and \"components\" can match it",
                      2);
      }
    }
    const Result result = timedMatch(input, options);
    if (flags.json) {
      writeJson(result, flags.timing, out);
    } else {
      writeText(result, input, flags.timing, out);
    }
    out.flush();
    return out ? 0 : failed("cannot write the result", 1);
  } catch (const std::invalid_argument& e) {
    return failed(flags.path + ": " + e.what(), 1);
  }
}

int runMatch(const MatchFileOptions& flags, std::ostream& out, std::ostream& err) {
  return runMatch(flags, std::cin, out, err);
}

}  // namespace shoal::console
