// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/tune.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <variant>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "operator_console/bar.h"
#include "operator_console/stop_signal.h"
#include "shoal/eval/bayesian_search.h"
#include "shoal/eval/experiment.h"
#include "shoal/eval/parallel.h"
#include "shoal/eval/statistics.h"
#include "shoal/eval/topic_tally.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/robot/profile.h"
#include "shoal/version.h"

namespace shoal::console {
namespace {

using Json = nlohmann::ordered_json;

/// The search space that ships: what the paper's authors searched, cut to where a count budget makes sense.
template <typename Learning>
struct Parameter {
  eval::Knob knob;
  double Learning::*member;
};
const std::vector<Parameter<topics::Hyperparameters>>& parametersOf(const topics::Hyperparameters&) {
  static const std::vector<Parameter<topics::Hyperparameters>> all = {
      {{"alpha", 1e-3, 3.0}, &topics::Hyperparameters::alpha},
      {{"beta", 1e-2, 5.0}, &topics::Hyperparameters::beta},
      {{"gamma", 1e-9, 1e-1}, &topics::Hyperparameters::gamma},
      {{"neighbor_weight", 0.05, 1.0}, &topics::Hyperparameters::neighbor_weight},
  };
  return all;
}
const std::vector<Parameter<topics::CellLabelHyperparameters>>& parametersOf(
    const topics::CellLabelHyperparameters&) {
  static const std::vector<Parameter<topics::CellLabelHyperparameters>> all = {
      {{"evidence", 1.0, 100.0}, &topics::CellLabelHyperparameters::evidence},
      {{"beta", 1e-2, 10.0}, &topics::CellLabelHyperparameters::beta},
      {{"coupling", 0.1, 5.0}, &topics::CellLabelHyperparameters::coupling},
  };
  return all;
}

/// The knob of that name, and where it turns.
template <typename Learning>
const Parameter<Learning>& parameter(const Learning& learning, const std::string& name) {
  std::string known;
  for (const Parameter<Learning>& p : parametersOf(learning)) {
    if (p.knob.name == name) return p;
    known += (known.empty() ? "" : ", ") + p.knob.name;
  }
  throw std::invalid_argument("--knobs: \"" + name + "\" is unknown; known are " + known);
}

eval::Knob knob(const topics::LearnerHyperparameters& learning, const std::string& name) {
  return std::visit([&](const auto& h) { return parameter(h, name).knob; }, learning);
}
void turn(topics::LearnerHyperparameters& learning, const std::string& name, double value) {
  std::visit([&](auto& h) { h.*parameter(h, name).member = value; }, learning);
}

void check(const TuneOptions& o) {
  if (o.out.empty()) throw std::invalid_argument("--out is missing: a folder for what is tried");
  if (o.score != "alone" && o.score != "team") {
    throw std::invalid_argument("--score must be alone or team, got \"" + o.score + "\"");
  }
  const auto demand = [](const char* flag, int64_t value, int64_t least) {
    if (value < least)
      throw std::invalid_argument(fmt::format("{} must be at least {}, got {}", flag, least, value));
  };
  demand("--robots", o.num_robots, 1);
  demand("--observations", o.observations, 1);
  demand("--seeds", o.seeds, 1);
  demand("--random", o.random, 2);
  demand("--trials", o.trials, 1);
}

// The first two of the profile's, where none are named.
std::vector<std::string> usualKnobs(const topics::LearnerHyperparameters& learning) {
  return std::visit(
      [](const auto& h) {
        return std::vector{parametersOf(h)[0].knob.name, parametersOf(h)[1].knob.name};
      },
      learning);
}

double aloneScore(const eval::TeamWords& words, const eval::LearningOptions& learning) {
  const std::vector<world::WordsInCells> row = words.inOneRow(0);
  const auto all = static_cast<int32_t>(row.size());
  const auto belief = eval::learn(row, world::RobotId{0}, words.cell_size_m, learning, std::span(&all, 1));
  const eval::TeamTally counted = eval::tally(belief, words.truthOfCell(), eval::FusionRule::kNewestWins);
  std::vector<int> own;
  for (size_t i = 0; i < counted.topics.size(); ++i) own.push_back(static_cast<int>(i));
  return eval::score(counted, own).ami;
}

}  // namespace

Json tune(TuneOptions options) {
  check(options);
  const topics::LearnerHyperparameters base = robot::hyperparametersOf(options.profile);
  if (options.knobs.empty()) options.knobs = usualKnobs(base);
  std::vector<eval::Knob> knobs;
  for (const std::string& name : options.knobs) knobs.push_back(knob(base, name));
  catchStopSignals();

  world::SurveyOptions survey;
  survey.num_robots = options.num_robots;
  survey.observations = options.observations;
  const auto place = world::openPlace(options.world, options.seed);
  spdlog::info("{}: words of {} x {} images", options.world, options.num_robots, options.observations);
  std::filesystem::create_directories(options.out + "/words");
  const eval::TeamWords words = eval::lookAround(
      *place, options.seed, survey, options.profile,
      {.folder = options.out + "/words", .made_by = commit() + (" " + options.world), .images = nullptr});
  if (words.truth.empty()) throw std::invalid_argument(options.world + " has no labels to score against");

  // What is kept is worth something only for the same question to the same program.
  Json asked = {{"commit", commit()},           {"world", options.world},
                {"profile", options.profile},   {"score", options.score},
                {"robots", options.num_robots}, {"observations", options.observations},
                {"seeds", options.seeds},       {"random", options.random},
                {"seed", options.seed},         {"knobs", options.knobs}};
  const std::string path = options.out + "/trials.json";
  std::vector<eval::Tried> tried;
  std::vector<Json> rows;
  if (std::filesystem::exists(path)) {
    const Json kept = Json::parse(mapping::readFile(path), nullptr, false);
    if (kept.is_object() && kept.value("asked", Json()) == asked) {
      for (const Json& row : kept.at("trials")) {
        tried.push_back({row.at("values").get<std::vector<double>>(), row.at("ami").get<double>()});
        rows.push_back(row);
      }
      spdlog::info("{} settings were tried before", tried.size());
    } else {
      spdlog::warn("{} is of another question or program; it is begun anew", path);
    }
  }

  {
    Bar bar("settings");
    while (std::ssize(tried) < options.trials) {
      bar.show(std::ssize(tried), options.trials);
      if (stopSignal() != 0)
        throw std::runtime_error("stopped; what was tried is kept, the same command goes on from there");
      const std::vector<double> values = eval::nextSetting(knobs, tried, options.random, options.seed);
      topics::LearnerHyperparameters hyperparameters = base;
      for (size_t k = 0; k < values.size(); ++k) turn(hyperparameters, options.knobs[k], values[k]);
      std::vector<double> ami(static_cast<size_t>(options.seeds));
      eval::forEachInParallel(options.seeds, [&](int s) {
        const eval::LearningOptions learning{.profile = options.profile,
                                             .seed = options.seed + static_cast<uint64_t>(s),
                                             .hyperparameters = hyperparameters};
        ami[static_cast<size_t>(s)] =
            options.score == "alone"
                ? aloneScore(words, learning)
                : eval::scoreTeam(words, learning, {{.matcher = "clear", .similarity = "cosine"}})[0].ami;
      });
      const eval::Summary summary = eval::summarize(ami);
      tried.push_back({values, summary.mean});
      rows.push_back({{"values", values}, {"ami", summary.mean}, {"by_seed", ami}});
      mapping::writeFileAtomically(path, Json{{"asked", asked}, {"trials", rows}}.dump(1) + "\n");
    }
  }
  const size_t best = eval::bestSetting(knobs, tried);
  Json chosen = Json::object();
  for (size_t k = 0; k < knobs.size(); ++k) chosen[options.knobs[k]] = tried[best].values[k];
  Json result = {{"best", chosen}, {"ami", tried[best].score}, {"trials", tried.size()}, {"asked", asked}};
  mapping::writeFileAtomically(options.out + "/best.json", result.dump(2) + "\n");
  return result;
}

}  // namespace shoal::console
