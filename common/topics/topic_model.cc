// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/topics/topic_model.h"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <string>
#include <utility>

#include "shoal/topics/fixed_log.h"
#include "shoal/topics/schedule.h"

namespace shoal::topics {
namespace {

// Streams of their own, so that no other room that is given the same mission seed draws the same numbers.
constexpr uint64_t kCellStream = 0x746f706963730001;      // "topics", 1
constexpr uint64_t kScheduleStream = 0x746f706963730002;  // "topics", 2

constexpr ptrdiff_t kAhead = 16;    // visits for which memory is fetched
constexpr size_t kMaxWaiting = 32;  // visits that later ones may overtake

}  // namespace

TopicModel::TopicModel(const Hyperparameters& hyperparameters, int32_t vocabulary_size, uint64_t seed,
                       world::RobotId robot, const std::vector<KnownTopic>& known)
    : hyperparameters_(hyperparameters),
      seed_(seed),
      robot_(static_cast<uint64_t>(number(robot))),
      cell_stream_(hashCombine(hashCombine(seed, kCellStream), robot_)),
      gibbs_(hyperparameters, vocabulary_size),
      neighbor_counts_(static_cast<size_t>(gibbs_.stride())) {
  if (known.empty()) return;
  check(known, vocabulary_size, hyperparameters.max_topics);
  known_hash_ = hashOf(known);
  gibbs_.restoreTopics(numIdsOf(known), namesOf(known));
  for (const KnownTopic& topic : known) {
    const auto slot = static_cast<int32_t>(adopted_.size());
    gibbs_.addCounts(slot, topic.words, 1);
    adopted_.push_back({slot, topic.words});
  }
}

void TopicModel::observe(const world::WordsInCells& words) {
  add(words);
  refine(hyperparameters_.resamples_per_observation);
}

void TopicModel::add(const world::WordsInCells& words) {
  check(words, gibbs_.vocabularySize());
  if (words.observation <= observation_) {
    throw std::invalid_argument("observation numbers must ascend from 0, got " +
                                std::to_string(words.observation) + " after " + std::to_string(observation_));
  }
  observation_ = words.observation;
  time_ = words.time;
  latest_.clear();
  const int32_t num_known = numCells();
  const std::vector<double> bits = surprise(words);
  const std::vector<float> surprises = surprise_scale_.of(bits);
  std::vector<int32_t> num_tokens;  // before this image
  for (size_t i = 0; i < words.cells.size(); ++i) {
    const world::CellWords& cell_words = words.cells[i];
    const int32_t c = cellFor(cell_words.cell);
    latest_.push_back(c);
    Cell& cell = cells_[static_cast<size_t>(c)];
    if (c >= num_known && num_known > 0) surprise_scale_.add(bits[i]);
    cell.surprise = std::max(cell.surprise, surprises[i]);
    cell.seen_observation = observation_;
    cell.seen = time_;
    num_tokens.push_back(static_cast<int32_t>(cell.tokens.size()));
    const std::vector<Token> fresh = tokens(cell_words);
    cell.tokens.insert(cell.tokens.end(), fresh.begin(), fresh.end());
  }
  // In the order of the image, so that most cells find a neighbour whose words have topics already: drawing
  // every other cell first costs 3 % of perplexity.
  std::vector<Visit> first_draws, first_visits;
  for (size_t i = 0; i < latest_.size(); ++i) first_draws.push_back(nextVisitOf(latest_[i], num_tokens[i]));
  for (int32_t c = num_known; c < numCells(); ++c) first_visits.push_back(nextVisitOf(c, 0));
  run(first_draws);
  run(first_visits);
  for (const Visit& visit : first_visits) {
    num_resamples_ += std::ssize(cells_[static_cast<size_t>(visit.cell)].tokens);
  }
  gibbs_.nameTopics(time_);
}

void TopicModel::refine(int64_t resamples) {
  if (resamples < 0) {
    throw std::invalid_argument("resamples must be at least 0, got " + std::to_string(resamples));
  }
  if (cells_.empty()) return;
  const int64_t start = num_resamples_;
  const int64_t budget = resamples - overrun_;
  run(nextVisits(budget));
  overrun_ = num_resamples_ - start - budget;
  gibbs_.nameTopics(time_);
}

// Visits by the schedule, of so many words or a few more.
std::vector<TopicModel::Visit> TopicModel::nextVisits(int64_t resamples) {
  const VisitLaw law{hyperparameters_.tau, hyperparameters_.local_rate};
  std::array<int32_t, kAhead> chosen{};  // of the next visits
  const auto choose = [&](uint64_t visit) {
    Random random(seed_, kScheduleStream, robot_, visit);
    const int32_t c = nextVisit(law, latest_, numCells(), random);
    __builtin_prefetch(&cells_[static_cast<size_t>(c)]);
    chosen[visit % kAhead] = c;
  };
  for (uint64_t i = 0; i < kAhead; ++i) choose(num_visits_ + i);
  std::vector<Visit> visits;
  for (const int64_t start = num_resamples_; num_resamples_ - start < resamples;) {
    const int32_t c = chosen[num_visits_ % kAhead];
    choose(num_visits_++ + kAhead);
    visits.push_back(nextVisitOf(c, 0));
    num_resamples_ += std::ssize(visits.back().tokens);
  }
  return visits;
}

std::vector<world::TopicId> TopicModel::adopt(const std::vector<AdoptedTopic>& others) {
  std::vector<int32_t> slots;
  for (const AdoptedTopic& topic : others) {
    const bool ascends = std::ranges::adjacent_find(topic.words, std::ranges::greater_equal{},
                                                    &world::WordCount::word) == topic.words.end();
    if (!ascends || (!topic.words.empty() &&
                     (topic.words.front().word < 0 || topic.words.back().word >= gibbs_.vocabularySize()))) {
      throw std::invalid_argument("words of an adopted topic must ascend within the vocabulary");
    }
    slots.push_back(topic.own ? slotOf(*topic.own) : -1);
  }
  // What was adopted goes last, so that a topic that is adopted again never closes in between.
  std::vector<Adopted> former = std::exchange(adopted_, {});
  for (size_t i = 0; i < others.size(); ++i) {
    int32_t& slot = slots[i];
    if (others[i].words.empty()) continue;
    if (slot < 0 && gibbs_.slots().canOpen() && gibbs_.slots().firstClosed() < gibbs_.slots().size()) {
      slot = gibbs_.slots().firstClosed();
    }
    if (slot < 0) continue;
    gibbs_.addCounts(slot, others[i].words, 1);
    adopted_.push_back({slot, others[i].words});
  }
  for (const Adopted& topic : former) gibbs_.addCounts(topic.slot, topic.words, -1);
  gibbs_.nameTopics(time_);
  std::vector<world::TopicId> ids;
  for (const int32_t slot : slots) ids.push_back(slot < 0 ? world::TopicId{-1} : gibbs_.slots().id(slot));
  return ids;
}

int32_t TopicModel::slotOf(world::TopicId id) const {
  const TopicSlots& slots = gibbs_.slots();
  for (int32_t k = 0; k < slots.end(); ++k) {
    if (slots.isOpen(k) && slots.id(k) == id) return k;
  }
  throw std::invalid_argument("this robot has no topic " + std::to_string(number(id)));
}

Snapshot TopicModel::snapshot() const {
  Snapshot snapshot{gibbs_.vocabularySize(), topics(), {}};
  snapshot.cells.reserve(cells_.size());
  std::vector<float> neighbor_counts(neighbor_counts_.size());
  for (int32_t c = 0; c < numCells(); ++c) snapshot.cells.push_back(label(c, neighbor_counts));
  std::ranges::sort(snapshot.cells, {}, &CellLabel::cell);
  return snapshot;
}

Snapshot TopicModel::outline() const { return {gibbs_.vocabularySize(), topics(), {}}; }

std::vector<CellLabel> TopicModel::labels(std::span<const world::CellIndex> cells) const {
  std::vector<CellLabel> labels;
  labels.reserve(cells.size());
  std::vector<float> neighbor_counts(neighbor_counts_.size());
  for (const world::CellIndex& cell : cells) {
    if (const auto c = neighborhood_.find(cell)) labels.push_back(label(*c, neighbor_counts));
  }
  return labels;
}

std::vector<double> TopicModel::surprise(const world::WordsInCells& words) const {
  check(words, gibbs_.vocabularySize());
  std::vector<double> bits(words.cells.size());
  const TopicSlots& slots = gibbs_.slots();
  double all = 0;
  for (int32_t k = 0; k < slots.end(); ++k) all += static_cast<double>(gibbs_.topicCount(k));
  if (all == 0) return bits;
  const double beta = hyperparameters_.beta;
  std::vector<double> share(static_cast<size_t>(slots.end()));  // n_k / Σ_j n_j / (n_k + Vβ)
  for (int32_t k = 0; k < slots.end(); ++k) {
    const auto count = static_cast<double>(gibbs_.topicCount(k));
    share[static_cast<size_t>(k)] = count / all / (count + gibbs_.vocabularySize() * beta);
  }
  for (size_t i = 0; i < bits.size(); ++i) {
    int64_t log_sum = 0, num_words = 0;
    for (const world::WordCount& w : words.cells[i].words) {
      const std::span<const int32_t> row = gibbs_.wordCounts(w.word);
      double likelihood = 0;
      for (size_t k = 0; k < share.size(); ++k) likelihood += share[k] * (row[k] + beta);
      // Logarithms of integers are the same on every machine.
      const auto scaled = static_cast<uint64_t>(std::max(likelihood * 0x1p62, 1.0));
      log_sum += w.count * (62 * kLogOne - int64_t{fixedLog2(scaled)});
      num_words += w.count;
    }
    bits[i] = static_cast<double>(log_sum) / static_cast<double>(kLogOne * num_words);
  }
  return bits;
}

int32_t TopicModel::cellFor(const world::CellIndex& index) {
  const int32_t c = neighborhood_.insert(index);
  if (static_cast<size_t>(c) == cells_.size()) {
    cells_.push_back({.index = index, .tokens = {}, .seen = {}});
    cell_counts_.resize(cell_counts_.size() + static_cast<size_t>(gibbs_.stride()));
    marks_.emplace_back();
  }
  return c;
}

TopicModel::Visit TopicModel::nextVisitOf(int32_t c, int32_t first) {
  Cell& cell = cells_[static_cast<size_t>(c)];
  const uint64_t draw = cell.num_draws++;
  return {c, std::span(cell.tokens).subspan(static_cast<size_t>(first)),
          Random(cell_stream_, static_cast<uint64_t>(c), draw)};
}

// Each visit begins as soon as a lane is free, unless its cell or one beside it is being visited, or is to be
// by one that waits already: visits that can see each other keep their order.
void TopicModel::run(const std::vector<Visit>& visits) {
  std::vector<const Visit*> waiting;
  auto next = visits.begin();
  while (next != visits.end() || !waiting.empty() || gibbs_.numEntered() > 0) {
    if (++look_ == 0) {
      for (Marks& marks : marks_) marks.waited_for = 0;
      look_ = 1;
    }
    size_t num_waiting = 0;
    for (const Visit* visit : waiting) {
      if (!begin(*visit)) waiting[num_waiting++] = visit;
    }
    waiting.resize(num_waiting);
    for (; next != visits.end() && gibbs_.numEntered() < kLanes && waiting.size() < kMaxWaiting; ++next) {
      if (visits.end() - next > 2 * kAhead) neighborhood_.prefetch(next[2 * kAhead].cell);
      if (visits.end() - next > kAhead) prefetch(next[kAhead]);
      if (!begin(*next)) waiting.push_back(&*next);
    }
    gibbs_.advance();
    for (int32_t i = 0; i < gibbs_.numLeft(); ++i) {
      forAround(gibbs_.left(i), [](Marks& marks) { --marks.num_visited; });
    }
  }
}

// Fetches what begin() and the draws will read.
void TopicModel::prefetch(const Visit& visit) const {
  const auto fetch = [](const auto* from, size_t size) {
    const auto* const bytes = reinterpret_cast<const char*>(from);
    for (size_t at = 0; at < size; at += 64) __builtin_prefetch(bytes + at);
  };
  fetch(visit.tokens.data(), std::min<size_t>(visit.tokens.size_bytes(), 512));
  const size_t row = std::min<size_t>(countsOf(visit.cell).size_bytes(), 256);
  fetch(countsOf(visit.cell).data(), row);
  for (const int32_t neighbor : neighborhood_.of(visit.cell)) {
    fetch(countsOf(neighbor).data(), row);
    fetch(&marks_[static_cast<size_t>(neighbor)], 1);
  }
}

bool TopicModel::begin(const Visit& visit) {
  // First draws go one by one: they learn from each other most.
  const bool is_first = visit.tokens.back().slot < 0;
  if (gibbs_.numEntered() >= (is_first ? 1 : kLanes)) return false;
  const Marks& marks = marks_[static_cast<size_t>(visit.cell)];
  if (marks.num_visited > 0 || marks.waited_for == look_) {
    forAround(visit.cell, [&](Marks& around) { around.waited_for = look_; });
    return false;
  }
  gatherNeighbors(visit.cell, neighbor_counts_);
  gibbs_.enter(visit.cell, visit.tokens, countsOf(visit.cell), neighbor_counts_, visit.random);
  forAround(visit.cell, [](Marks& around) { ++around.num_visited; });
  return true;
}

template <typename Change>
void TopicModel::forAround(int32_t c, const Change& change) {
  change(marks_[static_cast<size_t>(c)]);
  for (const int32_t neighbor : neighborhood_.of(c)) change(marks_[static_cast<size_t>(neighbor)]);
}

void TopicModel::gatherNeighbors(int32_t c, std::span<float> counts) const {
  const auto weight = static_cast<float>(hyperparameters_.neighbor_weight);
  const std::span<const int32_t> neighbors = neighborhood_.of(c);
  const int32_t* const rows = cell_counts_.data();
  const auto stride = static_cast<size_t>(gibbs_.stride());
  for (size_t k = 0; k < stride; k += kSlotsTogether) {
    std::array<int32_t, kSlotsTogether> sums{};  // of a length that compilers know
    for (const int32_t neighbor : neighbors) {
      const int32_t* const row = rows + static_cast<size_t>(neighbor) * stride + k;
      for (size_t i = 0; i < kSlotsTogether; ++i) sums[i] += row[i];
    }
    for (size_t i = 0; i < kSlotsTogether; ++i) counts[k + i] = static_cast<float>(sums[i]) * weight;
  }
}

std::span<int32_t> TopicModel::countsOf(int32_t c) {
  const auto stride = static_cast<size_t>(gibbs_.stride());
  return std::span(cell_counts_).subspan(static_cast<size_t>(c) * stride, stride);
}

std::span<const int32_t> TopicModel::countsOf(int32_t c) const {
  const auto stride = static_cast<size_t>(gibbs_.stride());
  return std::span(cell_counts_).subspan(static_cast<size_t>(c) * stride, stride);
}

CellLabel TopicModel::label(int32_t c, std::span<float> neighbor_counts) const {
  const TopicSlots& slots = gibbs_.slots();
  const std::span<const int32_t> counts = countsOf(c);
  gatherNeighbors(c, neighbor_counts);
  const double alpha = hyperparameters_.alpha;
  const int32_t num_options = hyperparameters_.gamma == 0.0 ? slots.size() : slots.numOpen();
  double mass = alpha * num_options;
  int32_t best = -1;
  for (int32_t k = 0; k < slots.end(); ++k) {
    const auto i = static_cast<size_t>(k);
    mass += counts[i] + double{neighbor_counts[i]};
    if (!slots.isOpen(k)) continue;
    const int32_t lead = best < 0 ? 1 : counts[i] - counts[static_cast<size_t>(best)];
    if (lead > 0 || (lead == 0 && slots.id(k) < slots.id(best))) best = k;
  }
  const auto b = static_cast<size_t>(best);
  const double certainty = (counts[b] + double{neighbor_counts[b]} + alpha) / mass;
  const Cell& cell = cells_[static_cast<size_t>(c)];
  return {cell.index,    slots.id(best),        static_cast<float>(std::min(certainty, 1.0)),
          cell.surprise, cell.seen_observation, cell.seen};
}

std::vector<TopicCounts> TopicModel::topics() const {
  const TopicSlots& slots = gibbs_.slots();
  std::vector<TopicCounts> by_slot(static_cast<size_t>(slots.end()));
  for (int32_t w = 0; w < gibbs_.vocabularySize(); ++w) {
    const std::span<const int32_t> counts = gibbs_.wordCounts(w);
    for (size_t k = 0; k < by_slot.size(); ++k) {
      if (counts[k] > 0) by_slot[k].words.push_back({w, counts[k]});
    }
  }
  for (const Adopted& adopted : adopted_) {  // not this robot's own
    subtract(by_slot[static_cast<size_t>(adopted.slot)].words, adopted.words);
  }
  std::vector<TopicCounts> topics;
  for (int32_t k = 0; k < slots.end(); ++k) {
    if (!slots.isOpen(k)) continue;
    TopicCounts topic = std::move(by_slot[static_cast<size_t>(k)]);
    topic.id = slots.id(k);
    topic.created = slots.created(k);
    for (const world::WordCount& w : topic.words) topic.weight += w.count;
    if (topic.weight > 0) topics.push_back(std::move(topic));
  }
  std::ranges::sort(topics, {}, &TopicCounts::id);
  return topics;
}

}  // namespace shoal::topics
