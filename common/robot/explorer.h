// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "shoal/mapping/believed_bricks.h"
#include "shoal/mapping/local_belief.h"
#include "shoal/mapping/piece.h"
#include "shoal/robot/example_book.h"
#include "shoal/topics/make_learner.h"
#include "shoal/topics/topic_model.h"
#include "shoal/vision/word_extractor.h"
#include "shoal/world/grid.h"
#include "shoal/world/observation.h"

namespace shoal::robot {

/// What makes an explorer. All of it changes what it learns, unless said otherwise.
struct ExplorerOptions {
  world::RobotId robot{};
  std::string profile = "best";                                   ///< words and hyper-parameters
  uint64_t seed = 1;                                              ///< mission seed
  double cell_size_m = 0.8;                                       ///< edge of a cell, > 0
  int32_t epoch = 0;                                              ///< grows when the robot has lost its disk
  std::optional<topics::LearnerHyperparameters> hyperparameters;  ///< other than the profile's, to experiment
  std::vector<topics::KnownTopic> known = {};       ///< topics to begin with: known_topics_file.h
  bool keeps_pictures = false;                      ///< of what its topics look like; changes nothing else
  mapping::Detail detail = mapping::Detail::kFine;  ///< of what it tells; changes nothing that it learns
};

/// Milliseconds of CPU that the last observation took, by stage.
struct StageTimes {
  double words_ms = 0, topics_ms = 0, belief_ms = 0, pictures_ms = 0;
  double total() const { return words_ms + topics_ms + belief_ms + pictures_ms; }
};

/// One robot's mind: takes observations, learns topics, hands out what it believes. The process and the
/// in-process experiments run this same code.
class Explorer final : public mapping::BelievedBricks {
 public:
  /// @throws std::invalid_argument for a profile that does not exist or a cell size that is not > 0.
  explicit Explorer(const ExplorerOptions& options);

  /// Learns from one image. Observations come in order of their numbers. The belief is a pure function of the
  /// options and of the observations so far.
  void observe(const world::Observation& observation);

  /// The same from the image's words, as words() extracted them with this cell size.
  void learn(const world::WordsInCells& words);

  /// What the robot believes now.
  mapping::LocalBelief belief() const;

  /// The same without its cells, which can be had brick by brick: costs the same on every map.
  mapping::LocalBelief outline() const;
  std::vector<mapping::BelievedCell> cellsOf(const mapping::Brick& brick) const override;
  std::optional<mapping::Brick> after(const std::optional<mapping::Brick>& brick) const override;

  /// The bricks of which cells were seen since the last call, or since restore().
  std::set<mapping::Brick> takeSeenBricks() { return std::exchange(seen_bricks_, {}); }

  int32_t numCells() const { return learner_->numCells(); }

  /// Learns from others' topics as well as from its own words: TopicModel::adopt().
  /// @throws std::invalid_argument unless the robot labels every word, as profile "paper" does.
  std::vector<world::TopicId> adopt(const std::vector<topics::AdoptedTopic>& others);

  /// Judges every cell anew by what the whole team knows, once all have seen what they were to see:
  /// Learner::lookAgain(). What comes of it is a belief of its own, with a version above that of the last
  /// image; an image that comes later must have a number above it.
  /// @throws as Learner::lookAgain(); std::logic_error unless canLookAgain().
  void lookAgain(
      const topics::TeamTopics& team, const std::function<void()>& breathe = [] {});

  /// Robots of profile "best" can.
  bool canLookAgain() const { return learner_->canLookAgain(); }

  /// Whether it did so and has not learnt since.
  bool hasLookedAgain() const { return looked_again_; }

  /// The whole mind as bytes: topics, labels, what was learnt about the camera, the observation number. An
  /// explorer made with the same options (the epoch apart, which is the caller's) and restored from them goes
  /// on as this one does, byte for byte.
  std::vector<uint8_t> checkpoint() const;

  /// Takes over the mind of the explorer that wrote the checkpoint, in place of its own.
  /// @throws std::runtime_error naming what is wrong with bytes that are damaged, of another version, or of
  ///         an explorer that was made with something else; this one is then as it was.
  void restore(std::span<const uint8_t> checkpoint);

  /// Number of the last observation learnt from, one more when it has looked again since; -1 before the
  /// first.
  int32_t lastObservation() const { return last_observation_; }

  const std::vector<world::WordGroup>& groups() const { return words_->groups(); }
  /// Identifies words and hyper-parameters: only robots with equal fingerprints are comparable.
  uint64_t fingerprint() const;
  /// The same, told apart, for others to compare.
  mapping::SettingsPart settings() const;
  int64_t droppedWords() const { return dropped_words_; }
  const StageTimes& lastTimes() const { return times_; }

 private:
  mapping::LocalBelief beliefOf(topics::Snapshot&& snapshot) const;
  void note(const world::CellIndex& cell);

  ExplorerOptions options_;
  std::unique_ptr<vision::WordExtractor> words_;
  world::Grid grid_;
  topics::LearnerHyperparameters hyperparameters_;
  std::unique_ptr<topics::Learner> learner_;
  std::optional<ExampleBook> book_;                                 // when it keeps pictures
  std::map<mapping::Brick, std::vector<world::CellIndex>> bricks_;  // ascending
  std::set<mapping::Brick> seen_bricks_;
  int32_t last_observation_ = -1;
  bool looked_again_ = false;
  int64_t dropped_words_ = 0;
  StageTimes times_;  // measured, never part of a result
};

}  // namespace shoal::robot
