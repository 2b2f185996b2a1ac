// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/evaluation.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <filesystem>
#include <memory>
#include <set>
#include <stdexcept>
#include <thread>
#include <unordered_set>

#include "shoal/eval/ami.h"
#include "shoal/eval/cell_truth.h"
#include "shoal/mapping/belief_files.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/fusion.h"

namespace shoal::eval {
namespace fs = std::filesystem;
namespace {

/// Shows every frame of a team to `look(half, frame)`, on two threads: half 0 or 1, one at a time each.
template <typename Look>
void forEachFrame(const world::Place& place, world::SurveyOptions team, Look&& look) {
  team.sensors = {};
  std::vector<std::unique_ptr<world::ObservationSource>> sources;  // made here, where it may throw
  for (int robot = 0; robot < team.num_robots; ++robot) sources.push_back(place.source(team, robot));
  std::atomic<size_t> next{0};
  const auto take = [&](size_t half) {
    for (size_t robot = next++; robot < sources.size(); robot = next++) {
      while (const auto frame = sources[robot]->next()) look(half, *frame);
    }
  };
  const std::jthread other(take, 1);
  take(0);
}

using Columns = std::unordered_set<world::CellIndex, world::CellHash>;  // z = 0; counted, never listed

Columns columnsWithin(const world::Extent& extent, const world::Grid& grid) {
  const world::CellIndex first = grid.cellOf({extent.min_x, extent.min_y, 0});
  const world::CellIndex last = grid.cellOf({extent.max_x, extent.max_y, 0});
  Columns columns;
  for (int32_t x = first.x; x <= last.x; ++x) {
    for (int32_t y = first.y; y <= last.y; ++y) {
      const Eigen::Vector3d p = grid.centerOf({x, y, 0});
      const bool inside =
          p.x() >= extent.min_x && p.x() <= extent.max_x && p.y() >= extent.min_y && p.y() <= extent.max_y;
      if (inside) columns.insert({x, y, 0});
    }
  }
  return columns;
}

Columns columnsSeen(const world::Place& place, const world::SurveyOptions& team, const world::Grid& grid) {
  std::array<Columns, 2> halves;
  forEachFrame(place, team, [&](size_t half, const world::Observation& frame) {
    for (int v = 0; v < frame.depth_m.rows; ++v) {
      for (int u = 0; u < frame.depth_m.cols; ++u) {
        const double depth = frame.depth_m.at<float>(v, u);
        if (!(depth > 0.0) || !std::isfinite(depth)) continue;
        const world::CellIndex cell =
            grid.cellOf(frame.world_from_camera * frame.intrinsics.unproject(u, v, depth));
        halves[half].insert({cell.x, cell.y, 0});
      }
    }
  });
  halves[0].merge(halves[1]);
  return halves[0];
}

}  // namespace

Run readRun(const std::string& dir, const world::Grid& grid) {
  Run run;
  if (!fs::is_directory(fs::path(dir) / "robots")) {
    throw std::runtime_error(dir + " is not a finished run: it has no folder \"robots\"");
  }
  std::vector<world::RobotId> robots;
  for (const auto& entry : fs::directory_iterator(fs::path(dir) / "robots")) {
    if (const auto robot = world::parseRobotId(entry.path().filename().string())) robots.push_back(*robot);
  }
  std::ranges::sort(robots);
  for (const world::RobotId robot : robots) {
    const std::string folder = dir + "/robots/" + name(robot);
    run.robots.push_back(mapping::readBelief(folder, robot, grid));
  }
  if (fs::exists(fs::path(dir) / "single" / "map.csv")) {
    run.single = mapping::readBelief(dir + "/single", world::RobotId{0}, grid);
  }
  return run;
}

TruthOfCell truthFor(const world::Place& place, const world::SurveyOptions& team, const world::Grid& grid) {
  if (place.hasFlatTruth()) {
    return [&place, grid](const world::CellIndex& cell) { return flatTruth(place, grid, cell); };
  }
  if (place.classes().empty()) {
    return [](const world::CellIndex&) { return std::optional<int>(); };
  }
  std::array<ProjectedTruth, 2> halves{ProjectedTruth(grid), ProjectedTruth(grid)};
  forEachFrame(place, team, [&](size_t half, const world::Observation& frame) { halves[half].add(frame); });
  halves[0].add(halves[1]);
  const auto truth = std::make_shared<const ProjectedTruth>(std::move(halves[0]));
  return [truth](const world::CellIndex& cell) { return truth->at(cell); };
}

Score score(const std::vector<std::pair<world::CellIndex, int>>& labels, const TruthOfCell& truth) {
  Score result{.cells = std::ssize(labels)};
  std::set<int> all_labels;
  std::vector<int> found, expected;
  for (const auto& [cell, label] : labels) {
    all_labels.insert(label);
    if (const auto true_class = truth(cell)) {
      found.push_back(label);
      expected.push_back(*true_class);
    }
  }
  result.scored = std::ssize(found);
  result.labels = static_cast<int>(all_labels.size());
  result.classes = static_cast<int>(std::set<int>(expected.begin(), expected.end()).size());
  if (found.empty()) return result;
  const Contingency table = contingency(found, expected);
  result.ami = ami(table);
  result.nmi = nmi(table);
  return result;
}

std::vector<Score> scoreMatchers(const Run& run, const std::vector<matching::MatcherOptions>& matchers,
                                 const TruthOfCell& truth) {
  mapping::BeliefStore store;
  for (const mapping::LocalBelief& belief : run.robots)
    for (const mapping::Piece& piece : mapping::wholePieces(belief)) store.apply(piece);
  std::vector<Score> scores;
  for (const matching::MatcherOptions& options : matchers) {
    std::vector<std::pair<world::CellIndex, int>> labels;
    for (const mapping::GlobalCell& c : mapping::fuse(store, options).cells) {
      labels.emplace_back(c.cell, number(c.label));
    }
    scores.push_back(score(labels, truth));
  }
  return scores;
}

Score scoreSingle(const mapping::LocalBelief& single, const TruthOfCell& truth) {
  std::vector<std::pair<world::CellIndex, int>> labels;
  for (const mapping::BelievedCell& c : single.cells) labels.emplace_back(c.cell, number(c.topic));
  return score(labels, truth);
}

std::vector<matching::MatcherOptions> allMatchers() {
  return {{.matcher = "id"},
          {.matcher = "hungarian", .similarity = "l2"},
          {.matcher = "incremental", .similarity = "cosine"},
          {.matcher = "clear", .similarity = "cosine"},
          {.matcher = "shoal", .similarity = "discounted"}};
}

double coverageOf(const std::vector<world::CellIndex>& cells, const world::Place& place,
                  const world::SurveyOptions& team, const world::Grid& grid) {
  Columns mapped;
  for (const world::CellIndex& c : cells) mapped.insert({c.x, c.y, 0});
  const Columns all = place.extent() ? columnsWithin(*place.extent(), grid) : columnsSeen(place, team, grid);
  const auto covered =
      std::ranges::count_if(all, [&](const auto& column) { return mapped.contains(column); });
  return all.empty() ? 0.0 : static_cast<double>(covered) / static_cast<double>(all.size());
}

}  // namespace shoal::eval
