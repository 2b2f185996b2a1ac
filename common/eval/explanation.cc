// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/explanation.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <span>
#include <utility>

#include "shoal/eval/topic_tally.h"
#include "shoal/mapping/belief_pieces.h"
#include "shoal/mapping/fusion.h"

namespace shoal::eval {
namespace {

int64_t sum(const std::vector<int64_t>& counts) {
  return std::accumulate(counts.begin(), counts.end(), int64_t{0});
}

int majorityOf(const std::vector<int64_t>& counts) {
  const auto most = std::ranges::max_element(counts);
  return most == counts.end() || *most == 0 ? -1 : static_cast<int>(most - counts.begin());
}

double share(int64_t part, int64_t whole) {
  return whole == 0 ? 0.0 : static_cast<double>(part) / static_cast<double>(whole);
}

std::vector<Explanation::Label> labelsOf(const mapping::GlobalMap& map, const TruthOfCell& truth,
                                         size_t classes) {
  std::map<world::GlobalLabel, Explanation::Label> rows;
  for (const mapping::GlobalCell& cell : map.cells) {
    Explanation::Label& row = rows[cell.label];
    row.label = cell.label;
    row.cells_of_class.resize(classes);
    ++row.cells;
    if (const auto id = truth(cell.cell)) ++row.cells_of_class[static_cast<size_t>(*id)];
  }
  std::vector<Explanation::Label> labels;
  for (auto& [label, row] : rows) {
    row.majority = majorityOf(row.cells_of_class);
    labels.push_back(std::move(row));
  }
  std::ranges::stable_sort(labels, std::ranges::greater{}, &Explanation::Label::cells);
  return labels;
}

std::vector<Explanation::Confusion> confusionsOf(const std::vector<Explanation::Label>& labels) {
  std::map<std::pair<int, int>, int64_t> cells;
  for (const Explanation::Label& label : labels) {
    for (size_t c = 0; c < label.cells_of_class.size(); ++c) {
      if (static_cast<int>(c) != label.majority && label.cells_of_class[c] > 0) {
        cells[{static_cast<int>(c), label.majority}] += label.cells_of_class[c];
      }
    }
  }
  std::vector<Explanation::Confusion> confusions;
  for (const auto& [pair, count] : cells) confusions.push_back({pair.first, pair.second, count});
  std::ranges::stable_sort(confusions, std::ranges::greater{}, &Explanation::Confusion::cells);
  return confusions;
}

std::vector<Explanation::Robot> robotsOf(const Run& run, const TeamTally& counted, const TruthOfCell& truth) {
  std::vector<Explanation::Robot> robots;
  for (const mapping::LocalBelief& belief : run.robots) {
    Explanation::Robot robot{.robot = belief.robot, .ami = scoreSingle(belief, truth).ami};
    int64_t right = 0, scored = 0;
    for (const TopicTally& topic : counted.topics) {
      if (topic.robot != belief.robot || topic.cells == 0) continue;
      ++robot.topics;
      robot.cells += topic.cells;
      if (topic.cells_of_class.empty()) continue;
      right += *std::ranges::max_element(topic.cells_of_class);
      scored += sum(topic.cells_of_class);
    }
    robot.purity = share(right, scored);
    robots.push_back(robot);
  }
  return robots;
}

}  // namespace

Explanation explain(const Run& run, const matching::MatcherOptions& matcher, const TruthOfCell& truth) {
  mapping::BeliefStore store;
  for (const mapping::LocalBelief& belief : run.robots) {
    for (const mapping::Piece& piece : mapping::wholePieces(belief)) store.apply(piece);
  }
  const mapping::GlobalMap map = mapping::fuse(store, matcher);
  const TeamTally counted = tally(run.robots, truth, FusionRule::kNewestWins);

  Explanation result;
  std::vector<std::pair<world::CellIndex, int>> cells;
  for (const mapping::GlobalCell& cell : map.cells) cells.emplace_back(cell.cell, number(cell.label));
  result.fused = score(cells, truth);
  result.oracle = score(counted, majorityClasses(counted));
  result.purity = purity(counted);
  result.labels = labelsOf(map, truth, static_cast<size_t>(counted.num_classes));
  result.confusions = confusionsOf(result.labels);
  result.robots = robotsOf(run, counted, truth);
  int64_t wrong = 0;
  for (const Explanation::Confusion& c : result.confusions) wrong += c.cells;
  result.label_purity = share(result.fused.scored - wrong, result.fused.scored);
  return result;
}

}  // namespace shoal::eval
