// SPDX-License-Identifier: BSD-3-Clause
// CellLabelModel::lookAgain(): what is told of cells, by the topics of the whole team.
#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

#include "shoal/topics/cell_certainty.h"
#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/team_opinion.h"

namespace shoal::topics {
namespace {

constexpr int kRounds = 6;
constexpr int32_t kCellsAtOnce = 1024;  // between two breaths
constexpr int64_t kLeast = std::numeric_limits<int64_t>::min();

void check(const TeamTopics& team, int32_t vocabulary_size) {
  for (const TeamTopics::Foreign& topic : team.others) {
    int64_t total = 0;
    int32_t last = -1;
    for (const world::WordCount& w : topic.words) {
      total += w.count;
      if (w.word <= last || w.word >= vocabulary_size || w.count < 1 || total > TeamTopics::kMostWords)
        throw std::invalid_argument("word " + std::to_string(w.word) +
                                    " of a topic of the team is out of order or range");
      last = w.word;
    }
  }
}

}  // namespace

// The team's labels that this robot has a topic of, numbered from 0 in order of the slots. A topic without a
// label of the team has one of its own.
CellLabelModel::TeamLabels CellLabelModel::labelsOf(const TeamTopics& team) const {
  const std::vector<int32_t> told = toldAs();
  TeamLabels labels;
  labels.of_slot.assign(told.size(), -1);
  std::map<world::TopicId, int32_t> alone;
  for (int32_t k = 0; k < slots_.end(); ++k) {
    if (!slots_.isOpen(k)) continue;
    const world::TopicId topic = slots_.id(told[static_cast<size_t>(k)]);
    const auto known = team.own.find(topic);
    int32_t& label = known == team.own.end() ? alone.try_emplace(topic, -1).first->second
                                             : labels.of_team.try_emplace(known->second, -1).first->second;
    if (label < 0) label = labels.count++;
    labels.of_slot[static_cast<size_t>(k)] = label;
  }
  return labels;
}

void CellLabelModel::lookAgain(const TeamTopics& team, const std::function<void()>& breathe) {
  check(team, counts_.vocabularySize());
  if (cells_.empty()) return;
  const TeamLabels labels = labelsOf(team);
  TeamOpinion others(counts_.groups(), hyperparameters_.beta, team, labels.of_team);
  LabelCandidates candidates(neighborhood_, scale_);
  std::vector<int64_t> row(static_cast<size_t>(labels.count)), in_favour(row.size());
  for (const LabelledCell& cell : cells_) {
    if (candidates.numCells() % kCellsAtOnce == 0) breathe();
    std::ranges::fill(row, kLeast);
    counts_.logLikelihoods(cell.words, cell.slot, scores_);
    for (int32_t k = 0; k < slots_.end(); ++k) {
      const int32_t label = labels.of_slot[static_cast<size_t>(k)];
      if (label < 0) continue;
      int64_t& best = row[static_cast<size_t>(label)];
      best = std::max(best, scores_[static_cast<size_t>(k)]);
    }
    others.ask(cell.words, cell.num_words, row, in_favour);
    candidates.add(row, cell.num_words, in_favour);
  }
  const std::vector<int32_t> likeliest = likeliestLabels(candidates, kRounds, breathe);
  for (size_t c = 0; c < cells_.size(); ++c) {
    if (c % kCellsAtOnce == 0) breathe();
    tellAgain(cells_[c], likeliest[c], candidates.of(static_cast<int32_t>(c)), labels);
  }
}

// As the likeliest of its own topics of that label, unless it is told as one.
void CellLabelModel::tellAgain(LabelledCell& cell, int32_t label,
                               std::span<const LabelCandidates::Candidate> candidates,
                               const TeamLabels& labels) {
  cell.told = toldSlot(cell);
  if (labels.of_slot[static_cast<size_t>(cell.told)] != label) {
    counts_.logLikelihoods(cell.words, cell.slot, scores_);
    int64_t best = kLeast;
    for (int32_t k = 0; k < slots_.end(); ++k) {
      const auto i = static_cast<size_t>(k);
      if (labels.of_slot[i] != label || scores_[i] <= best) continue;
      best = scores_[i];
      cell.told = k;
    }
  }
  cell.told_openings = slots_.openings(cell.told);
  int64_t its = 0, other = labels.count > 1 ? kLeast : -cell.num_words * log_group_size_;
  for (const LabelCandidates::Candidate& candidate : candidates) {
    if (candidate.label == label) {
      its = candidate.log_likelihood;
    } else {
      other = std::max(other, candidate.log_likelihood);
    }
  }
  cell.certainty = cellCertainty(its, other, cell.num_words, log_group_size_);
}

}  // namespace shoal::topics
