// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/explorer.h"

#include <algorithm>
#include <bit>
#include <stdexcept>

#include "shoal/cpu_time.h"
#include "shoal/demand.h"
#include "shoal/random.h"
#include "shoal/robot/profile.h"

namespace shoal::robot {
namespace {

class Stopwatch {
 public:
  double lapMs() {
    const double now_ms = threadCpuMs(), ms = now_ms - start_ms_;
    start_ms_ = now_ms;
    return ms;
  }

 private:
  double start_ms_ = threadCpuMs();
};

mapping::BelievedCell believed(const topics::CellLabel& c) {
  return {c.cell, c.topic, c.seen, c.certainty, c.surprise};
}

}  // namespace

Explorer::Explorer(const ExplorerOptions& options)
    : options_(options),
      words_(vision::makeWordExtractor(options.profile)),
      grid_(options.cell_size_m),
      hyperparameters_(options.hyperparameters.value_or(hyperparametersOf(options.profile))),
      learner_(topics::makeLearner(hyperparameters_, words_->groups(), options.seed, options.robot,
                                   options.known)) {
  if (options.keeps_pictures) book_.emplace(options.cell_size_m);
}

void Explorer::observe(const world::Observation& observation) {
  SHOAL_DEMAND(observation.number > last_observation_);
  Stopwatch watch;
  const world::WordsInCells words = words_->extract(observation, grid_);
  const double words_ms = watch.lapMs();
  learn(words);
  times_.words_ms = words_ms;
  watch.lapMs();
  if (!book_) return;
  const mapping::LocalBelief belief = beliefOf(learner_->outline());
  times_.belief_ms = watch.lapMs();
  book_->look(observation, words, belief,
              [&](const world::CellIndex& cell) -> std::optional<mapping::BelievedCell> {
                const std::vector<topics::CellLabel> label = learner_->labels({&cell, 1});
                if (label.empty()) return std::nullopt;
                return believed(label.front());
              });
  times_.pictures_ms = watch.lapMs();
}

void Explorer::learn(const world::WordsInCells& words) {
  SHOAL_DEMAND(words.observation > last_observation_);
  Stopwatch watch;
  learner_->observe(words);
  for (const world::CellWords& seen : words.cells) {
    note(seen.cell);
    seen_bricks_.insert(mapping::brickOf(seen.cell));
  }
  times_ = {.words_ms = 0, .topics_ms = watch.lapMs(), .belief_ms = 0, .pictures_ms = 0};
  last_observation_ = words.observation;
  looked_again_ = false;
  dropped_words_ += words.dropped_words;
}

void Explorer::lookAgain(const topics::TeamTopics& team, const std::function<void()>& breathe) {
  learner_->lookAgain(team, breathe);
  ++last_observation_;
  looked_again_ = true;
}

void Explorer::note(const world::CellIndex& cell) {
  std::vector<world::CellIndex>& cells = bricks_[mapping::brickOf(cell)];
  const auto place = std::ranges::lower_bound(cells, cell);
  if (place == cells.end() || *place != cell) cells.insert(place, cell);
}

mapping::LocalBelief Explorer::belief() const { return beliefOf(learner_->snapshot()); }

mapping::LocalBelief Explorer::outline() const { return beliefOf(learner_->outline()); }

mapping::LocalBelief Explorer::beliefOf(topics::Snapshot&& snapshot) const {
  mapping::LocalBelief belief{.robot = options_.robot,
                              .version = {options_.epoch, last_observation_},
                              .groups = words_->groups(),
                              .topics = {},
                              .cells = {},
                              .detail = options_.detail};
  for (topics::TopicCounts& topic : snapshot.topics) {
    belief.topics.push_back({topic.id, topic.created, topic.weight, std::move(topic.words)});
  }
  belief.cells.reserve(snapshot.cells.size());
  for (const topics::CellLabel& c : snapshot.cells) belief.cells.push_back(believed(c));
  if (book_) belief.examples = book_->examples();
  return belief;
}

std::vector<mapping::BelievedCell> Explorer::cellsOf(const mapping::Brick& brick) const {
  const auto found = bricks_.find(brick);
  if (found == bricks_.end()) return {};
  std::vector<mapping::BelievedCell> cells;
  cells.reserve(found->second.size());
  for (const topics::CellLabel& c : learner_->labels(found->second)) cells.push_back(believed(c));
  return cells;
}

std::optional<mapping::Brick> Explorer::after(const std::optional<mapping::Brick>& brick) const {
  const auto next = brick ? bricks_.upper_bound(*brick) : bricks_.begin();
  if (next == bricks_.end()) return std::nullopt;
  return next->first;
}

std::vector<world::TopicId> Explorer::adopt(const std::vector<topics::AdoptedTopic>& others) {
  auto* const model = dynamic_cast<topics::TopicModel*>(learner_.get());
  if (model == nullptr) {
    throw std::invalid_argument("a robot of profile \"" + options_.profile +
                                "\" learns a label per cell and adopts no topics; use \"paper\"");
  }
  return model->adopt(others);
}

mapping::SettingsPart Explorer::settings() const {
  return {words_->fingerprint(), topics::fingerprint(hyperparameters_), options_.cell_size_m};
}

uint64_t Explorer::fingerprint() const {
  return hashCombine(hashCombine(words_->fingerprint(), std::bit_cast<uint64_t>(options_.cell_size_m)),
                     topics::fingerprint(hyperparameters_));
}

}  // namespace shoal::robot
