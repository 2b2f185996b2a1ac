// SPDX-License-Identifier: BSD-3-Clause
#include "operator_console/reproduce.h"

#include <atomic>
#include <chrono>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <thread>
#include <variant>

#include <spdlog/fmt/fmt.h>
#include <spdlog/spdlog.h>

#include "operator_console/bar.h"
#include "operator_console/render.h"
#include "operator_console/reproduce_report.h"
#include "operator_console/stop_signal.h"
#include "shoal/eval/parallel.h"
#include "shoal/mapping/atomic_file.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/fusion.h"
#include "shoal/robot/profile.h"
#include "shoal/version.h"

namespace shoal::console {
namespace {

namespace fs = std::filesystem;
using PlainJson = nlohmann::json;

void demandNotStopped() {
  if (stopSignal() != 0) {
    throw std::runtime_error("stopped; what is finished is kept, the same command goes on from there");
  }
}

// Draws a bar from a thread of its own while work goes on, for counters that other threads move.
class LiveBar {
 public:
  LiveBar(const std::string& what, const std::atomic<int64_t>& done, int64_t total)
      : thread_([what, &done, total](const std::stop_token& stop) {
          Bar bar(what);
          while (!stop.stop_requested()) {
            bar.show(done, total);
            std::this_thread::sleep_for(std::chrono::milliseconds(200));
          }
        }) {}

 private:
  std::jthread thread_;
};

void check(const ReproduceOptions& o) {
  if (o.out.empty()) throw std::invalid_argument("--out is missing: a folder for the report");
  if (o.worlds.empty()) throw std::invalid_argument("--world is missing, as in --world reef:sparse");
  const auto demand = [](const char* flag, int64_t value, int64_t least, int64_t most) {
    if (value < least || value > most) {
      throw std::invalid_argument(fmt::format("{} must lie in {} to {}, got {}", flag, least, most, value));
    }
  };
  demand("--robots", o.num_robots, 1, 256);
  demand("--observations", o.observations, 1, 100'000);
  demand("--repeats", o.repeats, 1, 10'000);
  demand("--share-repeats", o.share_repeats, 0, 10'000);
  demand("--exchange-every", o.exchange_every, 0, 1'000'000);
  for (const int shares : o.shares) demand("--shares", shares, 1, 256);
  if (o.exchange_every > 0 && !canMergeModels(o.profile)) {
    throw std::invalid_argument("--exchange-every: robots of profile " + o.profile +
                                " do not merge models; leave it out or use --profile paper");
  }
}

class Experiment {
 public:
  Experiment(const ReproduceOptions& options, const std::vector<matching::MatcherOptions>& matchers,
             const std::string& world)
      : options_(options),
        matchers_(matchers),
        place_(world::openPlace(world, options.seed)),
        result_{.world = world, .repeats = {}, .by_shares = {}, .maps = {}} {
    if (place_->classes().empty()) throw std::invalid_argument(world + " has no labels to score against");
    robots_ = std::min(options.num_robots, place_->maxRobots());
    name_ = place_->name();
    for (char& c : name_) {
      if (c == ':' || c == '/') c = '_';
    }
  }

  WorldResult run() {
    const auto start = std::chrono::steady_clock::now();
    const eval::TeamWords words = look(robots_, options_.observations);
    result_.classes = static_cast<int>(place_->classes().size());
    result_.robots = robots_;
    result_.cell_size_m = words.cell_size_m;
    for (const auto& robot : words.robots) result_.images += std::ssize(robot);
    runRepeats(words);
    drawMaps(words);
    if (!place_->isRecorded() && options_.share_repeats > 0) {
      for (const int shares : options_.shares) cutInto(shares, words);
    }
    result_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return std::move(result_);
  }

  const std::string& world() const { return result_.world; }

 private:
  eval::TeamWords look(int robots, int32_t observations) {
    demandNotStopped();
    world::SurveyOptions survey;
    survey.num_robots = robots;
    survey.observations = observations;
    survey.cell_size_m = options_.cell_size_m;
    survey.altitude_m = options_.altitude_m;
    std::atomic<int64_t> images{0};
    const LiveBar bar(result_.world + ", words of " + std::to_string(robots) + " robots", images,
                      int64_t{robots} * observations);
    return eval::lookAround(
        *place_, options_.seed, survey, options_.profile,
        {.folder = options_.out + "/words", .made_by = commit() + (" " + result_.world), .images = &images});
  }

  eval::LearningOptions learning(int repeat) const {
    return {.profile = options_.profile,
            .seed = options_.seed + static_cast<uint64_t>(repeat),
            .hyperparameters = {}};
  }

  // What a finished piece of work depends on besides its file name.
  std::string keyOf(int robots, int32_t observations) const {
    std::string key =
        fmt::format("{} {} {} {} {} {} {} {} {}", version(), commit(), options_.profile, robots, observations,
                    options_.seed, options_.cell_size_m, options_.altitude_m, options_.exchange_every);
    for (const matching::MatcherOptions& m : matchers_) key += " " + eval::nameOf(m);
    return key;
  }

  // A finished piece of work from an earlier run; nothing when there is none, or of other options.
  std::optional<PlainJson> kept(const std::string& path, const std::string& key) const {
    if (!fs::exists(path)) return std::nullopt;
    PlainJson json = PlainJson::parse(mapping::readFile(path), nullptr, false);
    if (json.is_discarded() || !json.is_object() || json.value("key", "") != key) return std::nullopt;
    return json;
  }

  void runRepeats(const eval::TeamWords& words) {
    const std::string key = keyOf(robots_, options_.observations);
    result_.repeats.resize(static_cast<size_t>(options_.repeats));
    std::atomic<int64_t> done{0};
    const LiveBar bar(result_.world + ", repeats", done, options_.repeats);
    eval::forEachInParallel(options_.repeats, [&](int r) {
      demandNotStopped();
      eval::Repeat& repeat = result_.repeats[static_cast<size_t>(r)];
      const std::string path = fmt::format("{}/repeats/{}-{:03}.json", options_.out, name_, r);
      if (const std::optional<PlainJson> json = kept(path, key)) {
        json->at("repeat").get_to(repeat);
      } else {
        repeat = eval::runRepeat(words, {.learning = learning(r),
                                         .matchers = matchers_,
                                         .repeat = r,
                                         .exchange_every = options_.exchange_every,
                                         .measure_bytes = r == 0});
        mapping::writeFileAtomically(path, PlainJson{{"key", key}, {"repeat", repeat}}.dump());
        spdlog::debug("{}, repeat {}: {:.1f} s", result_.world, r, repeat.seconds);
      }
      ++done;
    });
  }

  // One area, one number of images altogether, more or fewer robots.
  void cutInto(int shares, const eval::TeamWords& whole) {
    const int repeats = std::min(options_.share_repeats, options_.repeats);
    const int64_t all = int64_t{options_.num_robots} * options_.observations;
    const auto observations = static_cast<int32_t>((all + shares - 1) / shares);
    const std::string key = keyOf(shares, observations);
    SharesResult result{.shares = shares, .ami = {}};
    result.ami.resize(static_cast<size_t>(repeats));
    std::optional<eval::TeamWords> words;
    const auto pathOf = [&](int r) {
      return fmt::format("{}/repeats/{}-{}-shares-{:03}.json", options_.out, name_, shares, r);
    };
    bool all_kept = true;
    for (int r = 0; r < repeats; ++r) all_kept = all_kept && kept(pathOf(r), key).has_value();
    if (!all_kept && shares != options_.num_robots) words = look(shares, observations);
    std::atomic<int64_t> done{0};
    const LiveBar bar(fmt::format("{}, {} shares", result_.world, shares), done, repeats);
    eval::forEachInParallel(repeats, [&](int r) {
      demandNotStopped();
      std::vector<double>& ami = result.ami[static_cast<size_t>(r)];
      if (const std::optional<PlainJson> json = kept(pathOf(r), key)) {
        json->at("ami").get_to(ami);
      } else {
        for (const eval::Score& s : eval::scoreTeam(words ? *words : whole, learning(r), matchers_))
          ami.push_back(s.ami);
        mapping::writeFileAtomically(pathOf(r), PlainJson{{"key", key}, {"ami", ami}}.dump());
      }
      ++done;
    });
    result_.by_shares.push_back(std::move(result));
  }

  // The first repeat's maps, each beside the truth.
  void drawMaps(const eval::TeamWords& words) {
    mapping::BeliefStore store;
    demandNotStopped();
    for (const mapping::LocalBelief& belief : eval::flyTeam(words, learning(0)))
      for (const mapping::Piece& piece : mapping::wholePieces(belief)) store.apply(piece);
    const TruthPicture truth{place_->classes(), words.truthOfCell()};
    for (const matching::MatcherOptions& m : matchers_) {
      const bool shown = m.matcher == "id" || (m.matcher == "hungarian" && m.similarity == "l2") ||
                         (m.matcher == "clear" && m.similarity == "cosine") || m.matcher == "shoal";
      if (!shown) continue;
      const mapping::GlobalMap map = mapping::fuse(store, m);
      const std::string title =
          fmt::format("{}, {}, {} labels", result_.world, eval::nameOf(m), map.labels.size());
      result_.maps.push_back(
          {eval::nameOf(m), encodePng(render(map, world::Grid(words.cell_size_m), title, truth))});
    }
  }

  const ReproduceOptions& options_;
  const std::vector<matching::MatcherOptions>& matchers_;
  std::unique_ptr<world::Place> place_;
  WorldResult result_;
  std::string name_;
  int robots_ = 0;  // a recording may have fewer than was asked for
};

}  // namespace

bool canMergeModels(const std::string& profile) {
  return std::holds_alternative<topics::Hyperparameters>(robot::hyperparametersOf(profile));
}

Reproduction reproduce(const ReproduceOptions& options) {
  check(options);
  catchStopSignals();
  fs::create_directories(options.out + "/words");
  Reproduction reproduction{.options = options, .matchers = eval::tableMatchers(), .worlds = {}};
  std::vector<Experiment> experiments;  // all opened first: what is wrong with the last is said at once
  for (const std::string& world : options.worlds)
    experiments.emplace_back(options, reproduction.matchers, world);
  for (Experiment& experiment : experiments) {
    spdlog::info("{}: {} repeats", experiment.world(), options.repeats);
    reproduction.worlds.push_back(experiment.run());
  }
  writeReport(reproduction);
  return reproduction;
}

}  // namespace shoal::console
