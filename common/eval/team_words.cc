// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/team_words.h"

#include <algorithm>
#include <array>
#include <bit>
#include <mutex>
#include <optional>

#include "shoal/eval/cell_truth.h"
#include "shoal/eval/parallel.h"
#include "shoal/eval/word_file.h"
#include "shoal/random.h"
#include "shoal/vision/word_extractor.h"

namespace shoal::eval {
namespace {

uint64_t keyOf(const world::Place& place, uint64_t place_seed, const world::SurveyOptions& survey,
               uint64_t words, const std::string& made_by) {
  uint64_t key = mix64(words);
  const auto add = [&key](uint64_t value) { key = hashCombine(key, value); };
  const auto addReal = [&add](double value) { add(std::bit_cast<uint64_t>(value)); };
  for (const char c : made_by + "\n" + place.name()) add(static_cast<uint64_t>(c));
  add(place_seed);
  add(static_cast<uint64_t>(survey.num_robots));
  add(static_cast<uint64_t>(survey.observations));
  const world::SensorOptions& sensors = survey.sensors;
  for (const double value :
       {sensors.exposure, sensors.color_cast, sensors.pose_drift, sensors.depth_noise, sensors.depth_holes}) {
    addReal(value);
  }
  const world::Intrinsics& camera = survey.intrinsics;
  add(static_cast<uint64_t>(camera.width));
  add(static_cast<uint64_t>(camera.height));
  for (const double value : {survey.cell_size_m, survey.altitude_m, survey.frame_period_s, camera.fx,
                             camera.fy, camera.cx, camera.cy}) {
    addReal(value);
  }
  return key;
}

CellTruth truthOf(const TeamWords& team, const TruthOfCell& truth) {
  std::vector<world::CellIndex> cells;
  for (const auto& robot : team.robots) {
    for (const world::WordsInCells& image : robot) {
      for (const world::CellWords& cell : image.cells) cells.push_back(cell.cell);
    }
    std::ranges::sort(cells);
    cells.erase(std::ranges::unique(cells).begin(), cells.end());
  }
  CellTruth known;
  for (const world::CellIndex& cell : cells) {
    if (const std::optional<int> id = truth(cell)) known.emplace_back(cell, static_cast<uint8_t>(*id));
  }
  return known;
}

}  // namespace

TruthOfCell TeamWords::truthOfCell() const {
  return [this](const world::CellIndex& cell) -> std::optional<int> {
    const auto found = std::ranges::lower_bound(truth, cell, {}, &CellTruth::value_type::first);
    if (found == truth.end() || found->first != cell) return std::nullopt;
    return found->second;
  };
}

std::vector<world::WordsInCells> TeamWords::inOneRow(size_t first) const {
  std::vector<world::WordsInCells> row;
  const int64_t period_us = robots.at(0).size() > 1 ? robots[0][1].time.us - robots[0][0].time.us : 1'000'000;
  for (size_t i = 0; i < robots.size(); ++i) {
    for (const world::WordsInCells& image : robots[(first + i) % robots.size()]) {
      row.push_back(image);
      row.back().observation = static_cast<int32_t>(row.size() - 1);
      row.back().time.us = static_cast<int64_t>(row.size() - 1) * period_us;
    }
  }
  return row;
}

TeamWords lookAround(const world::Place& place, uint64_t place_seed, const world::SurveyOptions& wanted,
                     const std::string& profile, const WordCache& cache) {
  const world::SurveyOptions survey = place.completed(wanted);
  const uint64_t words = vision::makeWordExtractor(profile)->fingerprint();
  const world::Grid grid(survey.cell_size_m);
  const uint64_t key = keyOf(place, place_seed, survey, words, cache.made_by);
  const auto fileOf = [&](const std::string& what) {
    constexpr std::string_view kDigits = "0123456789abcdef";
    std::string path = cache.folder + "/";
    for (int shift = 60; shift >= 0; shift -= 4) path += kDigits[key >> shift & 15];
    return path + "-" + what;
  };

  TeamWords team;
  team.cell_size_m = survey.cell_size_m;
  team.robots.resize(static_cast<size_t>(survey.num_robots));
  std::optional<CellTruth> known;
  if (!cache.folder.empty()) known = readTruthFile(fileOf("truth"), key);
  const bool projects = !known && !place.hasFlatTruth();
  ProjectedTruth projected(grid);
  std::mutex mutex;
  forEachInParallel(survey.num_robots, [&](int robot) {
    std::vector<world::WordsInCells>& images = team.robots[static_cast<size_t>(robot)];
    const std::string path = fileOf(world::name(world::RobotId{robot}));
    std::optional<std::vector<world::WordsInCells>> kept;
    if (!cache.folder.empty()) kept = readWordFile(path, key);
    if (kept) images = *std::move(kept);
    const bool looks = images.empty();
    if (looks || projects) {
      ProjectedTruth votes(grid);
      const auto extractor = vision::makeWordExtractor(profile);  // it learns about this robot's camera
      const auto source = place.source(survey, robot);
      while (const auto observation = source->next()) {
        if (looks) images.push_back(extractor->extract(*observation, grid));
        if (projects) votes.add(*observation);
        if (cache.images != nullptr) ++*cache.images;
      }
      const std::lock_guard lock(mutex);
      if (projects) projected.add(votes);
    } else if (cache.images != nullptr) {
      *cache.images += std::ssize(images);
    }
    if (looks && !cache.folder.empty()) writeWordFile(path, key, images);
  });
  if (known) {
    team.truth = *std::move(known);
  } else {
    const TruthOfCell truth = [&](const world::CellIndex& cell) {
      return projects ? projected.at(cell) : flatTruth(place, grid, cell);
    };
    team.truth = truthOf(team, truth);
    if (!cache.folder.empty()) writeTruthFile(fileOf("truth"), key, team.truth);
  }
  return team;
}

}  // namespace shoal::eval
