// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <span>
#include <vector>

#include "shoal/random.h"
#include "shoal/topics/cell_label_hyperparameters.h"
#include "shoal/topics/known_topics.h"
#include "shoal/topics/label_conditional.h"
#include "shoal/topics/label_counts.h"
#include "shoal/topics/learner.h"
#include "shoal/topics/likeliest_labels.h"
#include "shoal/topics/neighborhood.h"
#include "shoal/topics/surprise.h"
#include "shoal/topics/surprise_scale.h"
#include "shoal/topics/topic_slots.h"
#include "shoal/world/words_in_cells.h"

namespace shoal::topics {

/// One robot's map as one label per cell: a mixture of multinomials over kinds of words, smoothed by a Potts
/// prior over adjoining cells, learnt online.
///
/// A visit of a cell takes its words out of its label's counts, draws its label anew,
///
///     p(z = k) ∝ exp( t Σ_words ln((n_gkw + β) / (n_gk + V_g β)) + J #(neighbours with label k) ),
///
/// and puts the words back. Words of one cell are far from independent (kinds of words at one point, points
/// side by side, one place in many images), so t = min(1, evidence / words of the cell). Labels compete on
/// equal terms, however many cells they have: a prior in favour of large ones would eat small classes. At
/// most K labels are in use, and not more than one for every `cells_per_topic` cells seen (2 at least), so
/// that a robot that has seen little does not split hairs.
///
/// Labels find rare things when there are many, and cut common ones in pieces. So topics as told are sets of
/// labels that are alike (twin_labels.h), compared anew after each image; a topic's words are those of all
/// its labels, and it has the id of the oldest. Its labels part again when they grow unlike: an id that was
/// told as another then comes back, as the topic it always was.
///
/// What is told of a cell is not the label drawn, which is one of many that might have been, but the
/// likeliest by the same conditional, where neighbours vote by what is told of them, for all twins of it
/// alike.
///
/// observe() takes one image: its words join their cells, each of which is drawn anew, then a fixed count of
/// cells is visited (schedule.h). The cost of an observation does not depend on how much was seen before; a
/// visit costs (different words of the cell) x K additions.
///
/// The result is a function of (hyperparameters, groups, seed, robot, the sequence of calls): every draw has
/// random numbers of its own, keyed by seed, robot, cell and draw, and the conditional is computed in
/// integers. Equal inputs give equal bytes on every machine. A value: copying it forks the chain. Not
/// thread-safe.
///
/// Topic ids lie in [0, 9999], ascend with creation and are never used again: a label that loses its last
/// cell retires, and is another topic when it is drawn again (TopicSlots).
///
/// It differs from TopicModel in that a cell has no mixture of topics, only one, that kinds of words have
/// distributions of their own, and that K is fixed.
class CellLabelModel final : public Learner {
 public:
  /// @throws std::invalid_argument naming a hyperparameter out of range, or groups that leave gaps.
  ///         Known topics as check() of known_topics.h. Each is a label that never retires.
  CellLabelModel(const CellLabelHyperparameters& hyperparameters, const std::vector<world::WordGroup>& groups,
                 uint64_t seed, world::RobotId robot, const std::vector<KnownTopic>& known = {});

  /// add(words), then refine(visits_per_cell x its cells, rounded down).
  void observe(const world::WordsInCells& words) override;

  /// By the same conditional, where a topic is as likely as the best of all topics of its label makes it, and
  /// neighbours vote by what is told of them: first without votes, then so many rounds over all cells with
  /// them. Own topics of one label are one to it; a cell is told as the likeliest of them, or stays what it
  /// was told as when that is one. The certainty is that of the label.
  ///
  /// Cost: words x (K + topics of others) additions a cell, and for its time some 100 bytes.
  bool canLookAgain() const override { return true; }
  void lookAgain(
      const TeamTopics& team, const std::function<void()>& breathe = [] {}) override;

  /// Puts the words into their cells and draws the label of each of these cells. These draws are not part of
  /// any budget.
  /// @throws as observe().
  void add(const world::WordsInCells& words);

  /// Visits so many cells.
  /// @throws std::invalid_argument if visits < 0.
  void refine(int64_t visits);

  /// Topics as exact counts, every cell with its label.
  ///
  /// The topic of a cell is the likeliest when the cell was last drawn.
  /// The certainty of a cell is cellCertainty() of its topic, the best of its labels speaking for a topic,
  /// when the cell was last drawn. Its surprise is how unusual, compared with all the robot had seen, its
  /// words were to the model of the whole map just before they joined it, in the image that surprised most.
  ///
  /// Cost: O(V K + cells log cells).
  Snapshot snapshot() const override;
  Snapshot outline() const override;
  std::vector<CellLabel> labels(std::span<const world::CellIndex> cells) const override;

  /// The topic of the label that was drawn last for each cell, cells as in snapshot(): the state of the
  /// chain, whose words a topic's counts are. snapshot() tells the likeliest instead.
  std::vector<world::TopicId> drawnTopics() const;

  /// How surprising an image is to the model as it stands, before observe(): bitsPerWord() of each of its
  /// cells, in order, 0 while the map is empty. Cells that adjoin nothing known are compared with the whole
  /// map.
  /// @throws std::invalid_argument if `words` breaks its contract.
  std::vector<double> surprise(const world::WordsInCells& words, Surroundings surroundings) const;

  /// About 56 bytes a cell and 8 a different word of a cell.
  std::vector<uint8_t> checkpoint() const override;

  /// The model that wrote the checkpoint, given what it was made with.
  /// @throws std::runtime_error for bytes that are damaged, of another version, or of a model that was made
  /// with
  ///         something else; std::invalid_argument as the constructor.
  static CellLabelModel resumed(const CellLabelHyperparameters& hyperparameters,
                                const std::vector<world::WordGroup>& groups, uint64_t seed,
                                world::RobotId robot, std::span<const uint8_t> checkpoint,
                                const std::vector<KnownTopic>& known = {});

  int32_t numCells() const override { return neighborhood_.size(); }
  /// Topics as they are told, twins as one.
  int32_t numTopics() const override;
  /// How many labels may be in use now.
  int32_t topicLimit() const;
  int64_t numVisits() const { return static_cast<int64_t>(num_visits_); }

 private:
  struct LabelledCell {
    world::CellIndex index;
    std::vector<world::WordCount> words;  // ascending, all images together
    int64_t num_words = 0;                // the sum of their counts
    float certainty = 0;                  // when it was last drawn
    float surprise = 0;
    int32_t slot = -1;           // its label; -1 before the first draw
    int32_t told = -1;           // the likeliest when it was last drawn; -1 before
    uint32_t told_openings = 0;  // of that slot then: when it was opened again, it is another label
    uint32_t num_draws = 0;      // names its next random numbers
    int32_t seen_observation = 0;
    world::Timestamp seen;
  };

  // The team's labels that this robot has a topic of, by their numbers here.
  struct TeamLabels {
    int32_t count = 0;
    std::vector<int32_t> of_slot;        // -1: no topic
    std::map<int32_t, int32_t> of_team;  // by the team's number
  };

  uint64_t identity() const;
  void begin(const std::vector<KnownTopic>& known);
  int32_t cellFor(const world::CellIndex& index);
  void redraw(int32_t c, bool words_are_counted);
  float certaintyOf(const LabelledCell& cell, int32_t label) const;
  void relabel(LabelledCell& cell, int32_t slot);
  void tell(int32_t c);
  int32_t toldSlot(const LabelledCell& cell) const;
  CellLabel labelOf(const LabelledCell& cell, const std::vector<int32_t>& told_as) const;
  TeamLabels labelsOf(const TeamTopics& team) const;
  void tellAgain(LabelledCell& cell, int32_t label, std::span<const LabelCandidates::Candidate> candidates,
                 const TeamLabels& labels);
  void findTwins();
  void leaveTwins(int32_t slot);
  std::vector<int32_t> toldAs() const;
  std::vector<TopicCounts> topics() const;

  const CellLabelHyperparameters hyperparameters_;
  const ConditionalScale scale_;
  const uint64_t seed_;
  const uint64_t robot_;
  std::vector<KnownTopic> known_;  // in the first slots; in the counts, not this robot's own
  int64_t log_group_size_ = 0;     // mean of log2 over groups, in units of 2^-16
  LabelCounts counts_;
  TopicSlots slots_;
  Neighborhood neighborhood_;
  std::deque<LabelledCell> cells_;  // by number, as in neighborhood_; grows without moving what it holds
  std::vector<int32_t> cells_of_;   // by slot; one more of each known topic
  std::vector<int32_t> twin_of_;    // by slot: the lowest of its twins when last compared; itself when closed

  SurpriseScale surprise_scale_;

  std::vector<int32_t> latest_;  // cells of the latest observation
  int32_t observation_ = -1;     // its number
  world::Timestamp time_;        // and its time
  uint64_t num_visits_ = 0;      // of refine(): names the schedule's next random numbers

  std::vector<int64_t> scores_;  // of the cell being drawn, by slot
  std::vector<int32_t> alike_, votes_;
  std::vector<uint64_t> weights_;
};

}  // namespace shoal::topics
