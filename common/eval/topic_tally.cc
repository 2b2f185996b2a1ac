// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/eval/topic_tally.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "shoal/demand.h"
#include "shoal/eval/ami.h"

namespace shoal::eval {
namespace {

struct Shown {
  world::Timestamp seen;
  world::RobotId robot{};
  size_t topic = 0;
};

}  // namespace

TeamTally tally(std::span<const mapping::LocalBelief> team, const TruthOfCell& truth, FusionRule rule) {
  std::map<std::pair<world::RobotId, world::TopicId>, size_t> place;
  for (const mapping::LocalBelief& belief : team) {
    for (const mapping::BelievedCell& c : belief.cells) place.emplace(std::pair(belief.robot, c.topic), 0);
  }
  TeamTally result;
  for (auto& [key, index] : place) {
    index = result.topics.size();
    result.topics.push_back({.robot = key.first, .topic = key.second, .cells_of_class = {}});
  }
  const auto count = [&](const world::CellIndex& cell, size_t topic) {
    TopicTally& t = result.topics[topic];
    ++t.cells;
    const std::optional<int> id = truth(cell);
    if (!id) return;
    SHOAL_DEMAND(*id >= 0);
    result.num_classes = std::max(result.num_classes, *id + 1);
    if (t.cells_of_class.size() <= static_cast<size_t>(*id))
      t.cells_of_class.resize(static_cast<size_t>(*id) + 1);
    ++t.cells_of_class[static_cast<size_t>(*id)];
  };
  std::unordered_map<world::CellIndex, Shown, world::CellHash> shown;  // only sums leave it
  for (const mapping::LocalBelief& belief : team) {
    for (const mapping::BelievedCell& c : belief.cells) {
      const size_t topic = place.at({belief.robot, c.topic});
      if (rule == FusionRule::kConcatenate) {
        count(c.cell, topic);
        continue;
      }
      const auto [held, is_new] = shown.try_emplace(c.cell, Shown{c.seen, belief.robot, topic});
      Shown& other = held->second;
      if (!is_new && std::pair(other.seen, other.robot) < std::pair(c.seen, belief.robot)) {
        other = {c.seen, belief.robot, topic};
      }
    }
  }
  for (const auto& [cell, winner] : shown) count(cell, winner.topic);
  for (TopicTally& t : result.topics) t.cells_of_class.resize(static_cast<size_t>(result.num_classes));
  return result;
}

Score score(const TeamTally& tally, std::span<const int> label) {
  SHOAL_DEMAND(label.size() == tally.topics.size());
  std::map<int, std::vector<int64_t>> rows;
  Score result;
  std::set<int> shown;
  std::vector<int64_t> truth(static_cast<size_t>(tally.num_classes));
  for (size_t i = 0; i < label.size(); ++i) {
    const TopicTally& t = tally.topics[i];
    result.cells += t.cells;
    if (t.cells > 0) shown.insert(label[i]);
    const int64_t scored = std::accumulate(t.cells_of_class.begin(), t.cells_of_class.end(), int64_t{0});
    if (scored == 0) continue;
    result.scored += scored;
    std::vector<int64_t>& row = rows[label[i]];
    row.resize(truth.size());
    for (size_t c = 0; c < truth.size(); ++c) {
      row[c] += t.cells_of_class[c];
      truth[c] += t.cells_of_class[c];
    }
  }
  result.labels = static_cast<int>(shown.size());
  result.classes = static_cast<int>(std::ranges::count_if(truth, [](int64_t n) { return n > 0; }));
  if (result.scored == 0) return result;

  Contingency table;
  table.num_cells = result.scored;
  std::vector<int> column(truth.size(), -1);
  for (size_t c = 0; c < truth.size(); ++c) {
    if (truth[c] == 0) continue;
    column[c] = static_cast<int>(table.truth_ids.size());
    table.truth_ids.push_back(static_cast<int>(c));
    table.truth_cells.push_back(truth[c]);
  }
  for (const auto& [id, row] : rows) {
    const auto index = static_cast<int>(table.label_ids.size());
    table.label_ids.push_back(id);
    table.label_cells.push_back(std::accumulate(row.begin(), row.end(), int64_t{0}));
    for (size_t c = 0; c < row.size(); ++c) {
      if (row[c] > 0) table.counts.push_back({index, column[c], row[c]});
    }
  }
  result.ami = ami(table);
  result.nmi = nmi(table);
  return result;
}

std::vector<int> majorityClasses(const TeamTally& tally) {
  std::vector<int> majority;
  for (const TopicTally& t : tally.topics) {
    const auto most = std::ranges::max_element(t.cells_of_class);
    const bool has_truth = most != t.cells_of_class.end() && *most > 0;
    majority.push_back(has_truth ? static_cast<int>(most - t.cells_of_class.begin()) : -1);
  }
  return majority;
}

double purity(const TeamTally& tally) {
  int64_t right = 0, all = 0;
  for (const TopicTally& t : tally.topics) {
    if (t.cells_of_class.empty()) continue;
    right += *std::ranges::max_element(t.cells_of_class);
    all = std::accumulate(t.cells_of_class.begin(), t.cells_of_class.end(), all);
  }
  return all == 0 ? 0.0 : static_cast<double>(right) / static_cast<double>(all);
}

}  // namespace shoal::eval
