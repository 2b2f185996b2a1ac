// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/cell_label_model.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "shoal/demand.h"
#include "shoal/topics/cell_certainty.h"
#include "shoal/topics/cell_words.h"
#include "shoal/topics/fixed_log.h"
#include "shoal/topics/schedule.h"
#include "shoal/topics/twin_labels.h"

namespace shoal::topics {
namespace {

constexpr int32_t kFewestTopics = 2;
// Streams of their own, so that no other room that is given the same mission seed draws the same numbers.
constexpr uint64_t kCellStream = 0x6c6162656c730001;      // "labels", 1
constexpr uint64_t kScheduleStream = 0x6c6162656c730002;  // "labels", 2

const CellLabelHyperparameters& checked(const CellLabelHyperparameters& hyperparameters) {
  check(hyperparameters);
  return hyperparameters;
}

int64_t countOf(const std::vector<world::WordCount>& words) {
  return std::accumulate(words.begin(), words.end(), int64_t{0},
                         [](int64_t sum, const world::WordCount& w) { return sum + w.count; });
}

// Adds `more` to `words`, both ascending by word.
void merge(std::vector<world::WordCount>& words, const std::vector<world::WordCount>& more) {
  std::vector<world::WordCount> sum;
  sum.reserve(words.size() + more.size());
  auto word = words.begin();
  for (const world::WordCount& w : more) {
    for (; word != words.end() && word->word < w.word; ++word) sum.push_back(*word);
    sum.push_back(w);
    if (word != words.end() && word->word == w.word) sum.back().count += (word++)->count;
  }
  sum.insert(sum.end(), word, words.end());
  words = std::move(sum);
}

}  // namespace

CellLabelModel::CellLabelModel(const CellLabelHyperparameters& hyperparameters,
                               const std::vector<world::WordGroup>& groups, uint64_t seed,
                               world::RobotId robot, const std::vector<KnownTopic>& known)
    : hyperparameters_(checked(hyperparameters)),
      scale_(ConditionalScale::of(hyperparameters.evidence, hyperparameters.coupling)),
      seed_(seed),
      robot_(static_cast<uint64_t>(number(robot))),
      counts_(groups, hyperparameters.max_topics, hyperparameters.beta),
      slots_(hyperparameters.max_topics) {
  for (const world::WordGroup& group : counts_.groups())
    log_group_size_ += int64_t{fixedLog2(static_cast<uint64_t>(group.size))};
  log_group_size_ /= std::ssize(counts_.groups());
  const auto stride = static_cast<size_t>(counts_.stride());
  cells_of_.resize(stride);
  scores_.resize(stride);
  alike_.resize(stride);
  votes_.resize(stride);
  twin_of_.resize(stride);
  std::iota(twin_of_.begin(), twin_of_.end(), 0);
  weights_.resize(stride);
  if (known.empty()) return;
  check(known, counts_.vocabularySize(), hyperparameters.max_topics);
  slots_.restore(numIdsOf(known), namesOf(known));
  begin(known);
}

void CellLabelModel::begin(const std::vector<KnownTopic>& known) {
  known_ = known;
  for (size_t k = 0; k < known.size(); ++k) {
    counts_.add(known[k].words, static_cast<int32_t>(k));
    ++cells_of_[k];
  }
}

void CellLabelModel::observe(const world::WordsInCells& words) {
  add(words);
  refine(static_cast<int64_t>(hyperparameters_.visits_per_cell * static_cast<double>(latest_.size())));
}

void CellLabelModel::add(const world::WordsInCells& words) {
  check(words, counts_.vocabularySize());
  if (words.observation <= observation_) {
    throw std::invalid_argument("observation numbers must ascend from 0, got " +
                                std::to_string(words.observation) + " after " + std::to_string(observation_));
  }
  observation_ = words.observation;
  time_ = words.time;
  latest_.clear();
  const bool knows_nothing = cells_.empty() && known_.empty();
  const std::vector<double> bits = surprise(words, Surroundings::kGlobal);
  const std::vector<float> surprises = surprise_scale_.of(bits);
  for (size_t i = 0; i < words.cells.size(); ++i) {
    const world::CellWords& fresh = words.cells[i];
    const int32_t c = cellFor(fresh.cell);
    latest_.push_back(c);
    LabelledCell& cell = cells_[static_cast<size_t>(c)];
    if (cell.slot < 0 && !knows_nothing) surprise_scale_.add(bits[i]);
    cell.surprise = std::max(cell.surprise, surprises[i]);
    cell.seen_observation = observation_;
    cell.seen = time_;
    if (cell.slot >= 0) counts_.remove(cell.words, cell.slot);
    merge(cell.words, fresh.words);
    cell.num_words += countOf(fresh.words);
    redraw(c, false);
  }
  slots_.nameTopics(time_);
}

void CellLabelModel::refine(int64_t visits) {
  if (visits < 0) throw std::invalid_argument("visits must be at least 0, got " + std::to_string(visits));
  if (cells_.empty()) return;
  for (int64_t i = 0; i < visits; ++i) {
    Random random(seed_, kScheduleStream, robot_, num_visits_++);
    redraw(nextVisit({hyperparameters_.tau, hyperparameters_.local_rate}, latest_, numCells(), random), true);
  }
  slots_.nameTopics(time_);
  findTwins();
}

int32_t CellLabelModel::numTopics() const {
  int32_t sets = 0;
  for (int32_t k = 0; k < slots_.end(); ++k)
    sets += slots_.isOpen(k) && twin_of_[static_cast<size_t>(k)] == k;
  return sets;
}

int32_t CellLabelModel::topicLimit() const {
  const int32_t fewest = std::max(kFewestTopics, static_cast<int32_t>(known_.size()));
  const int32_t grown = std::max(numCells() / hyperparameters_.cells_per_topic, fewest);
  return std::min(grown, hyperparameters_.max_topics);
}

int32_t CellLabelModel::cellFor(const world::CellIndex& index) {
  const int32_t c = neighborhood_.insert(index);
  if (static_cast<size_t>(c) == cells_.size()) cells_.push_back({.index = index, .words = {}, .seen = {}});
  return c;
}

// Draws the label of a cell anew, whose words are in the counts of its label or (`words_are_counted` false)
// in none; afterwards they are in those of the label drawn.
void CellLabelModel::redraw(int32_t c, bool words_are_counted) {
  LabelledCell& cell = cells_[static_cast<size_t>(c)];
  const int32_t old = cell.slot;
  counts_.logLikelihoods(cell.words, words_are_counted ? old : -1, scores_);

  std::ranges::fill(alike_, kNotALabel);
  const int32_t limit = topicLimit();
  for (int32_t k = 0; k < limit; ++k) {
    if (slots_.isOpen(k) || slots_.canOpen()) alike_[static_cast<size_t>(k)] = 0;
  }
  for (const int32_t neighbor : neighborhood_.of(c)) {
    const int32_t slot = cells_[static_cast<size_t>(neighbor)].slot;
    if (slot >= 0) ++alike_[static_cast<size_t>(slot)];  // in one image some are not drawn yet
  }
  weighLabels(scores_, cell.num_words, alike_, scale_, weights_);
  Random random(hashCombine(seed_, kCellStream), robot_, static_cast<uint64_t>(c), cell.num_draws++);
  const int32_t drawn = drawLabel(weights_, random);
  if (!words_are_counted || drawn != old) {
    if (words_are_counted) counts_.remove(cell.words, old);
    counts_.add(cell.words, drawn);
    relabel(cell, drawn);
  }
  tell(c);
}

// By scores_, the likelihoods of its words without itself.
void CellLabelModel::tell(int32_t c) {
  LabelledCell& cell = cells_[static_cast<size_t>(c)];
  std::ranges::fill(votes_, 0);
  for (const int32_t neighbor : neighborhood_.of(c)) {
    const LabelledCell& beside = cells_[static_cast<size_t>(neighbor)];
    if (beside.slot >= 0) ++votes_[static_cast<size_t>(twin_of_[static_cast<size_t>(toldSlot(beside))])];
  }
  for (size_t k = 0; k < alike_.size(); ++k) {
    const bool is_label = static_cast<int32_t>(k) < slots_.end() && slots_.isOpen(static_cast<int32_t>(k));
    alike_[k] = is_label ? votes_[static_cast<size_t>(twin_of_[k])] : kNotALabel;
  }
  cell.told = likeliestLabel(scores_, cell.num_words, alike_, scale_);
  cell.told_openings = slots_.openings(cell.told);
  cell.certainty = certaintyOf(cell, cell.told);
}

int32_t CellLabelModel::toldSlot(const LabelledCell& cell) const {
  const bool is_there =
      cell.told >= 0 && slots_.isOpen(cell.told) && slots_.openings(cell.told) == cell.told_openings;
  return is_there ? cell.told : cell.slot;
}

// By scores_, the likelihoods of its words. Where there is no other topic, chance is the other.
float CellLabelModel::certaintyOf(const LabelledCell& cell, int32_t label) const {
  const int64_t chance = -cell.num_words * log_group_size_;
  int64_t own = scores_[static_cast<size_t>(label)];
  int64_t other = std::numeric_limits<int64_t>::min();
  for (int32_t k = 0; k < slots_.end(); ++k) {
    if (!slots_.isOpen(k)) continue;
    const auto i = static_cast<size_t>(k);
    int64_t& best = twin_of_[i] == twin_of_[static_cast<size_t>(label)] ? own : other;
    best = std::max(best, scores_[i]);
  }
  if (other == std::numeric_limits<int64_t>::min()) other = chance;
  return cellCertainty(own, other, cell.num_words, log_group_size_);
}

// Opens and retires labels as cells come and go.
void CellLabelModel::relabel(LabelledCell& cell, int32_t slot) {
  if (cell.slot == slot) return;
  if (cells_of_[static_cast<size_t>(slot)]++ == 0) slots_.open(slot);
  if (cell.slot >= 0 && --cells_of_[static_cast<size_t>(cell.slot)] == 0) {
    slots_.close(cell.slot);
    leaveTwins(cell.slot);
  }
  cell.slot = slot;
}

void CellLabelModel::findTwins() {
  std::vector<int32_t> open;
  for (int32_t k = 0; k < slots_.end(); ++k) {
    if (slots_.isOpen(k)) open.push_back(k);
  }
  const std::vector<int32_t> twins = twinLabels(counts_, open, hyperparameters_.twin_similarity);
  for (size_t i = 0; i < open.size(); ++i) twin_of_[static_cast<size_t>(open[i])] = twins[i];
}

// A set goes by its lowest label: when that one leaves, by the next.
void CellLabelModel::leaveTwins(int32_t slot) {
  twin_of_[static_cast<size_t>(slot)] = -1;
  const auto next = static_cast<int32_t>(std::ranges::find(twin_of_, slot) - twin_of_.begin());
  std::ranges::replace(twin_of_, slot, next);
  twin_of_[static_cast<size_t>(slot)] = slot;
}

// What each label is told as: the oldest of its twins, by slot.
std::vector<int32_t> CellLabelModel::toldAs() const {
  std::vector<int32_t> oldest(twin_of_.size(), -1);  // by lowest slot of the set
  for (int32_t k = 0; k < slots_.end(); ++k) {
    if (!slots_.isOpen(k)) continue;
    int32_t& known = oldest[static_cast<size_t>(twin_of_[static_cast<size_t>(k)])];
    if (known < 0 || slots_.id(k) < slots_.id(known)) known = k;
  }
  std::vector<int32_t> told;
  for (const int32_t twin : twin_of_) told.push_back(oldest[static_cast<size_t>(twin)]);
  return told;
}

Snapshot CellLabelModel::snapshot() const {
  Snapshot snapshot{counts_.vocabularySize(), topics(), {}};
  snapshot.cells.reserve(cells_.size());
  const std::vector<int32_t> told = toldAs();
  for (const LabelledCell& cell : cells_) snapshot.cells.push_back(labelOf(cell, told));
  std::ranges::sort(snapshot.cells, {}, &CellLabel::cell);
  return snapshot;
}

Snapshot CellLabelModel::outline() const { return {counts_.vocabularySize(), topics(), {}}; }

std::vector<CellLabel> CellLabelModel::labels(std::span<const world::CellIndex> cells) const {
  const std::vector<int32_t> told = toldAs();
  std::vector<CellLabel> labels;
  labels.reserve(cells.size());
  for (const world::CellIndex& cell : cells) {
    if (const auto c = neighborhood_.find(cell))
      labels.push_back(labelOf(cells_[static_cast<size_t>(*c)], told));
  }
  return labels;
}

CellLabel CellLabelModel::labelOf(const LabelledCell& cell, const std::vector<int32_t>& told_as) const {
  return {cell.index,
          slots_.id(told_as[static_cast<size_t>(toldSlot(cell))]),
          cell.certainty,
          cell.surprise,
          cell.seen_observation,
          cell.seen};
}

std::vector<world::TopicId> CellLabelModel::drawnTopics() const {
  std::vector<const LabelledCell*> cells;
  for (const LabelledCell& cell : cells_) cells.push_back(&cell);
  std::ranges::sort(cells, {}, &LabelledCell::index);
  const std::vector<int32_t> told = toldAs();
  std::vector<world::TopicId> topics;
  for (const LabelledCell* cell : cells) topics.push_back(slots_.id(told[static_cast<size_t>(cell->slot)]));
  return topics;
}

std::vector<double> CellLabelModel::surprise(const world::WordsInCells& words,
                                             Surroundings surroundings) const {
  check(words, counts_.vocabularySize());
  std::vector<double> bits(words.cells.size());
  if (cells_.empty() && known_.empty()) return bits;
  std::vector<int64_t> scores(scores_.size());
  std::vector<int32_t> around(cells_of_.size());
  for (size_t i = 0; i < bits.size(); ++i) {
    const world::CellWords& seen = words.cells[i];
    std::ranges::fill(around, 0);
    if (surroundings == Surroundings::kNeighborhood) {
      for (const int32_t c : neighborhood_.around(seen.cell)) {
        ++around[static_cast<size_t>(cells_[static_cast<size_t>(c)].slot)];
      }
    }
    const bool alone = std::ranges::count(around, 0) == std::ssize(around);
    counts_.logLikelihoods(seen.words, -1, scores);
    bits[i] = bitsPerWord(scores, alone ? cells_of_ : around, countOf(seen.words));
  }
  return bits;
}

std::vector<TopicCounts> CellLabelModel::topics() const {
  const std::vector<int32_t> told = toldAs();
  std::vector<TopicCounts> topics(static_cast<size_t>(slots_.end()));
  const size_t end = topics.size();
  for (int32_t w = 0; w < counts_.vocabularySize(); ++w) {
    const std::span<const int32_t> counts = counts_.wordCounts(w);
    for (size_t k = 0; k < end; ++k) {
      if (counts[k] == 0) continue;
      TopicCounts& topic = topics[static_cast<size_t>(told[k])];
      if (topic.words.empty() || topic.words.back().word != w) topic.words.push_back({w, 0});
      topic.words.back().count += counts[k];
      topic.weight += counts[k];
    }
  }
  for (size_t k = 0; k < known_.size(); ++k) {
    TopicCounts& topic = topics[static_cast<size_t>(told[k])];
    subtract(topic.words, known_[k].words);
    for (const world::WordCount& w : known_[k].words) topic.weight -= w.count;
  }
  for (int32_t k = 0; k < slots_.end(); ++k) {
    if (!slots_.isOpen(k)) continue;
    topics[static_cast<size_t>(k)].id = slots_.id(k);
    topics[static_cast<size_t>(k)].created = slots_.created(k);
  }
  std::erase_if(topics, [](const TopicCounts& topic) { return topic.words.empty(); });
  std::ranges::sort(topics, {}, &TopicCounts::id);
  return topics;
}

}  // namespace shoal::topics
