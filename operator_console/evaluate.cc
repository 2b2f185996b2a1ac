// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/evaluate.h"

#include <cmath>
#include <filesystem>
#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include <spdlog/fmt/fmt.h>

#include "fusion_node/process.h"
#include "operator_console/command.h"
#include "operator_console/explain.h"
#include "shoal/eval/team_learning.h"
#include "shoal/eval/topic_tally.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/rounded.h"
#include "shoal/world/place.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

// null where nothing is compared with it.
Json sigmaOf(const matching::MatcherOptions& m) {
  return matching::usesSigma(m.matcher) ? Json(m.leastSimilarity()) : Json(nullptr);
}

struct EvaluateFlags {
  std::string run, world, matcher = "all", similarity, sigma = "auto";
  bool json = false, explain = false;
};

// "reef:varied", or of a folder its last part: worlds are moved.
std::string nameOf(const std::string& world) {
  std::error_code not_here;  // "reef:varied", or a folder of another machine
  const auto folder = std::filesystem::canonical(world, not_here);
  const auto path = not_here ? std::filesystem::path(world).lexically_normal() : folder;
  return (path.has_filename() ? path : path.parent_path()).filename();
}

void evaluate(const EvaluateFlags& flags) {
  const Json summary = [&] {
    try {
      return Json::parse(mapping::readFile(flags.run + "/summary.json"));
    } catch (const Json::exception& error) {
      throw std::runtime_error(flags.run + "/summary.json: " + error.what());
    }
  }();
  const world::SurveyOptions team = teamOf(summary);
  warnOfOtherWorld(flags.run, summary, flags.world);
  const auto place = world::openPlace(flags.world, summary.at("seed").get<uint64_t>(), cameraOf(summary));
  std::vector<matching::MatcherOptions> matchers = eval::allMatchers();
  if (flags.matcher != "all") {
    matchers = {{.matcher = flags.matcher, .similarity = matching::usualSimilarity(flags.matcher)}};
    matching::match(matching::DescriptorSet{}, matchers[0]);  // an unknown matcher is refused here, by name
  }
  for (matching::MatcherOptions& options : matchers) {
    options.sigma = matching::parseSigma(flags.sigma);
    const bool fixed = flags.matcher == "all" && options.matcher == "shoal";  // it has one of its own
    if (!flags.similarity.empty() && !fixed) options.similarity = flags.similarity;
  }
  const Evaluation result = evaluateRun(flags.run, *place, team, matchers, flags.explain);
  if (flags.json) {
    std::cout << result.json().dump(2) << '\n';
  } else {
    std::cout << (place->classes().empty()
                      ? flags.world + " has no labels: there is nothing to score against\n"
                      : scoreTable(result));
    if (result.explanation) std::cout << explanationText(*result.explanation, place->classes());
  }
}

}  // namespace

void warnOfOtherWorld(const std::string& run, const Json& summary, const std::string& world) {
  const std::string flown = summary.value("world", world);
  if (nameOf(flown) != nameOf(world))
    std::cerr << run << " was flown over " << flown << "; this scores it against " << world << '\n';
}

Json Evaluation::json() const {
  const eval::Score& first = scores.at(0);
  Json result{{"cells", first.cells},       {"scored", first.scored},   {"coverage", rounded(coverage, 1e6)},
              {"cell_size_m", cell_size_m}, {"classes", first.classes}, {"matchers", Json::object()}};
  for (size_t i = 0; i < scores.size(); ++i) {
    result["matchers"][matchers[i].matcher] = {
        {"ami", rounded(scores[i].ami, 1e6)}, {"ami_concatenated", rounded(ami_concatenated[i], 1e6)},
        {"nmi", rounded(scores[i].nmi, 1e6)}, {"labels", scores[i].labels},
        {"sigma", sigmaOf(matchers[i])},      {"similarity", matchers[i].similarity}};
  }
  if (single)
    result["single"] = {
        {"ami", rounded(single->ami, 1e6)}, {"nmi", rounded(single->nmi, 1e6)}, {"labels", single->labels}};
  if (explanation) result["explanation"] = explanationJson(*explanation, truth.classes);
  return result;
}

std::optional<world::Camera> cameraOf(const Json& summary) {
  const auto camera = summary.find("camera");
  if (camera == summary.end() || camera->is_null()) return std::nullopt;
  return world::parseCamera(camera->dump(), "\"camera\" in summary.json");
}

world::SurveyOptions teamOf(const Json& summary) {
  try {
    world::SurveyOptions team;
    if (const auto camera = cameraOf(summary)) team.intrinsics = camera->intrinsics;
    team.num_robots = static_cast<int>(summary.at("robots").size());
    team.observations = summary.at("observations");
    team.cell_size_m = summary.at("cell_size_m");
    team.altitude_m = summary.at("altitude_m");
    team.frame_period_s = summary.value("frame_period_s", team.frame_period_s);
    return team;
  } catch (const Json::exception& error) {
    throw std::runtime_error(std::string("summary.json: ") + error.what());
  }
}

Evaluation evaluateRun(const std::string& dir, const world::Place& place, const world::SurveyOptions& team,
                       const std::vector<matching::MatcherOptions>& matchers, bool explain) {
  const world::Grid grid(team.cell_size_m);
  const eval::Run run = eval::readRun(dir, grid);
  Evaluation result;
  result.cell_size_m = team.cell_size_m;
  result.matchers = matchers;
  result.truth = {place.classes(), eval::truthFor(place, team, grid)};
  result.scores = eval::scoreMatchers(run, matchers, result.truth.of_cell);
  if (run.single) result.single = eval::scoreSingle(*run.single, result.truth.of_cell);
  const eval::Stacked stacked = eval::stackTeam(run.robots);
  const eval::TeamTally all =
      eval::tally(stacked.beliefs, result.truth.of_cell, eval::FusionRule::kConcatenate);
  for (const matching::MatcherOptions& options : matchers) {
    result.ami_concatenated.push_back(eval::scoreMatcher(stacked, all, options).ami);
  }
  if (explain) result.explanation = eval::explain(run, matchers.back(), result.truth.of_cell);
  std::vector<world::CellIndex> cells;
  for (const mapping::LocalBelief& belief : run.robots)
    for (const mapping::BelievedCell& c : belief.cells) cells.push_back(c.cell);
  result.coverage = eval::coverageOf(cells, place, team, grid);
  return result;
}

std::string scoreTable(const Evaluation& e) {
  std::string table = fmt::format("{:<34} {:>7} {:>7} {:>7}\n", "", "AMI", "NMI", "labels");
  const auto row = [&table](const std::string& what, const eval::Score& s) {
    table += fmt::format("{:<34} {:>7.3f} {:>7.3f} {:>7}\n", what, s.ami, s.nmi, s.labels);
  };
  for (size_t i = 0; i < e.scores.size(); ++i) {
    const matching::MatcherOptions& m = e.matchers[i];
    std::string what = m.matcher;
    if (m.matcher == "id") what = "ID (topic j is topic j)";
    if (m.matcher == "hungarian") what = "sequential Hungarian, " + m.similarity;
    if (m.matcher == "incremental") {
      what = fmt::format("incremental Hungarian, {} {:.2f}", m.similarity, m.leastSimilarity());
    }
    if (m.matcher == "components") {
      what = fmt::format("components, {} {:.2f}", m.similarity, m.leastSimilarity());
    }
    if (m.matcher == "clear") what = fmt::format("CLEAR, {} {:.2f}", m.similarity, m.leastSimilarity());
    if (m.matcher == "shoal") what = fmt::format("Shoal {:.2f}", m.leastSimilarity());
    row(what, e.scores[i]);
  }
  if (e.single) row("one robot that saw the same area", *e.single);
  const eval::Score& s = e.scores.at(0);
  return table + fmt::format("{} of {} cells have a truth, {} classes, coverage {:.1f} %\n", s.scored,
                             s.cells, s.classes, e.coverage * 100);
}

void addEvaluateCommand(CLI::App& app, Action& chosen) {
  CLI::App* command = app.add_subcommand("evaluate", "score a finished mission against its world");
  const auto flags = std::make_shared<EvaluateFlags>();
  command->add_option("--run", flags->run, "folder of the mission")->required();
  command->add_option("--world", flags->world, "the world it was flown over")->required();
  command
      ->add_option("--matcher", flags->matcher, "all, id, hungarian, incremental, components, clear or shoal")
      ->capture_default_str();
  command->add_option("--similarity", flags->similarity,
                      "cosine, overlap, l1, l2, hellinger, js or discounted (default: the matcher's usual)");
  command
      ->add_option("--sigma", flags->sigma,
                   "least similarity of a match: auto (the matcher's usual) or a number in (0, 1]")
      ->capture_default_str();
  command->add_flag("--explain", flags->explain,
                    "why: the ceiling of any matcher, purity by robot, what each label holds");
  command->add_flag("--json", flags->json, "answer in JSON");
  command->footer(
      "  operator_console evaluate --run runs/a --world reef:varied\n"
      "  operator_console evaluate --run runs/a --world bay --matcher clear --sigma 0.75 --explain");
  command->callback([flags, &chosen] {
    chosen = [flags] {
      evaluate(*flags);
      return 0;
    };
  });
}

}  // namespace shoal::console
