// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "shoal/topics/cell_words.h"
#include "shoal/topics/gibbs.h"
#include "shoal/topics/hyperparameters.h"
#include "shoal/topics/known_topics.h"
#include "shoal/topics/learner.h"
#include "shoal/topics/neighborhood.h"
#include "shoal/topics/surprise_scale.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// What others know of a topic, for TopicModel::adopt().
struct AdoptedTopic {
  std::optional<world::TopicId> own;    ///< the topic of this robot that it is; none: it is new here
  std::vector<world::WordCount> words;  ///< the others' counts, ascending by word
};

/// BNP-ROST: one robot's spatio-temporal topic model, learnt online from visual words in cells.
///
/// observe() takes one image: its words join their cells, then a fixed count of words is re-sampled, half of
/// them (local_rate) in the newest image and half in the past, the recent past more often. The cost of an
/// observation does not depend on how much was seen before; only snapshot() reads everything.
///
/// The result is a function of (hyperparameters, vocabulary size, seed, robot, the sequence of calls): every
/// visit of a cell has random numbers of its own, keyed by seed, robot, cell and visit. Equal inputs give
/// equal bytes. A value: copying it forks the chain. Not thread-safe.
///
/// Topic ids lie in [0, 9999], ascend with creation and are never used again (TopicSlots). When they have
/// run out no new topic opens.
///
/// Source: S. Jamieson et al. 2021, §IV-A, after Y. Girdhar et al. 2016, arXiv:1509.07979.
class TopicModel final : public Learner {
 public:
  /// @throws std::invalid_argument naming a hyperparameter out of range (check()), or vocabulary_size < 1.
  ///         Known topics as check() of known_topics.h.
  TopicModel(const Hyperparameters& hyperparameters, int32_t vocabulary_size, uint64_t seed,
             world::RobotId robot, const std::vector<KnownTopic>& known = {});

  /// add(words), then refine(resamples_per_observation). An image without words still refines the past.
  /// @throws as add().
  void observe(const world::WordsInCells& words) override;

  /// Puts the words into their cells. Each word's first topic is drawn from its conditional (the reference
  /// draws it uniformly), then every new cell is visited once. These draws are not part of any budget.
  /// @throws std::invalid_argument, leaving the model as it was, if `words` breaks its contract or its
  ///         observation number is not above the last one's.
  void add(const world::WordsInCells& words);

  /// Visits cells until `resamples` words have been re-sampled. A visit re-samples every word of its cell, so
  /// the last one may overrun; the overrun is taken off the next call, which keeps the total exact to a cell.
  /// @throws std::invalid_argument if resamples < 0.
  void refine(int64_t resamples);

  /// Takes over what other robots know: their counts are added to this robot's in the conditional, in place
  /// of those adopted before, and of known ones. Topics that are new here get a slot and an id of their own
  /// while there are free slots, and are left out otherwise. snapshot() goes on telling this robot's own
  /// counts.
  /// @returns the id of each topic here, in order; -1 where it was left out.
  /// @throws std::invalid_argument for an `own` that is not an open topic, or words out of order or range.
  /// Source: K. Doherty, G. Flaspohler, N. Roy, Y. Girdhar, ICRA 2018: merge and redistribute.
  std::vector<world::TopicId> adopt(const std::vector<AdoptedTopic>& others);

  /// Topics as exact counts, every cell with its label: argmax_k n_ck, ties to the lowest id.
  ///
  /// The certainty of a label k is the share of the cell's neighbourhood posterior that k holds,
  /// (N_ck + α) / Σ_j (N_cj + α), with N_ck as in Gibbs and j over all K slots when K is fixed (γ = 0), over
  /// the open topics otherwise.
  ///
  /// Cost: O(V K + cells (K + log cells)); about 5 ms for 20 000 cells, V = 15436, K = 12.
  Snapshot snapshot() const override;
  Snapshot outline() const override;
  std::vector<CellLabel> labels(std::span<const world::CellIndex> cells) const override;

  /// How surprising an image is to the model as it stands, before observe(): of each cell, in order, the mean
  /// over its words of -log2 Σ_k n_k / Σ_j n_j · (n_kw + β) / (n_k + Vβ), bits per word; 0 while nothing was
  /// seen. snapshot() tells how unusual they were (SurpriseScale).
  /// @throws std::invalid_argument if `words` breaks its contract.
  std::vector<double> surprise(const world::WordsInCells& words) const;

  /// About 44 bytes a cell and 4 a word.
  std::vector<uint8_t> checkpoint() const override;

  /// The model that wrote the checkpoint, given what it was made with.
  /// @throws std::runtime_error for bytes that are damaged, of another version, or of a model that was made
  ///         with something else; std::invalid_argument as the constructor.
  static TopicModel resumed(const Hyperparameters& hyperparameters, int32_t vocabulary_size, uint64_t seed,
                            world::RobotId robot, std::span<const uint8_t> checkpoint,
                            const std::vector<KnownTopic>& known = {});

  int32_t numCells() const override { return neighborhood_.size(); }
  int32_t numTopics() const override { return gibbs_.slots().numOpen(); }
  /// Words re-sampled so far by visits, those of add() included.
  int64_t numResamples() const { return num_resamples_; }

 private:
  uint64_t identity() const;
  int32_t cellFor(const world::CellIndex& index);

  // Words of a cell to be drawn.
  struct Visit {
    int32_t cell;
    std::span<Token> tokens;
    Random random;
  };
  Visit nextVisitOf(int32_t cell, int32_t first);
  std::vector<Visit> nextVisits(int64_t resamples);
  void run(const std::vector<Visit>& visits);
  bool begin(const Visit& visit);
  void prefetch(const Visit& visit) const;
  template <typename Change>
  void forAround(int32_t cell, const Change& change);
  void gatherNeighbors(int32_t cell, std::span<float> counts) const;
  std::span<int32_t> countsOf(int32_t cell);
  std::span<const int32_t> countsOf(int32_t cell) const;
  CellLabel label(int32_t cell, std::span<float> neighbor_counts) const;
  std::vector<TopicCounts> topics() const;

  // Of a cell while visits are under way.
  struct Marks {
    uint32_t waited_for = 0;  // the last look at which a visit to it or beside it had to wait
    int32_t num_visited = 0;  // how many of it and those beside it are being visited
  };

  struct Adopted {
    int32_t slot;
    std::vector<world::WordCount> words;
  };
  int32_t slotOf(world::TopicId id) const;

  const Hyperparameters hyperparameters_;
  const uint64_t seed_;
  const uint64_t robot_;
  uint64_t known_hash_ = 0;     // of the topics it began with
  const uint64_t cell_stream_;  // of random numbers
  Gibbs gibbs_;
  Neighborhood neighborhood_;
  std::deque<Cell> cells_;            // by number, as in neighborhood_
  std::vector<int32_t> cell_counts_;  // n_ck, one row of gibbs_.stride() a cell
  std::vector<float> neighbor_counts_;
  std::vector<Marks> marks_;  // by number
  uint32_t look_ = 0;
  std::vector<Adopted> adopted_;  // in the count tables, not this robot's own

  SurpriseScale surprise_scale_;

  std::vector<int32_t> latest_;  // cells of the latest observation
  int32_t observation_ = -1;     // its number
  world::Timestamp time_;        // and its time
  uint64_t num_visits_ = 0;      // of refine(): names the schedule's next random numbers
  int64_t num_resamples_ = 0;
  int64_t overrun_ = 0;
};

}  // namespace shoal::topics
