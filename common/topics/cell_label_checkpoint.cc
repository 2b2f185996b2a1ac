// SPDX-License-Identifier: BSD-3-Clause
// CellLabelModel's state to bytes and back. What follows from the rest is left out: counts follow from cells
// and their labels, neighbours from cells in order.
#include <algorithm>
#include <bit>
#include <cmath>
#include <initializer_list>
#include <utility>

#include "shoal/topics/cell_label_model.h"
#include "shoal/topics/make_learner.h"
#include "shoal/topics/state_bytes.h"

namespace shoal::topics {
namespace {

const std::string kLabelModelKind = "shoalCLM";
constexpr uint32_t kLabelModelVersion = 4;
constexpr size_t kCellBytes = 56, kWordBytes = 8;

}  // namespace

// What a model is made with: a checkpoint of another is none.
uint64_t CellLabelModel::identity() const {
  uint64_t hash = hashCombine(fingerprint(hyperparameters_), seed_);
  hash = hashCombine(hash, robot_);
  for (const world::WordGroup& group : counts_.groups()) {
    hash = hashCombine(hash, static_cast<uint64_t>(group.size));
  }
  return hashCombine(hash, hashOf(known_));
}

std::vector<uint8_t> CellLabelModel::checkpoint() const {
  StateWriter out(kLabelModelKind, kLabelModelVersion);
  out.u64(identity());
  out.i32(observation_);
  out.i64(time_.us);
  out.u64(num_visits_);
  out.i32(slots_.numIdsUsed());
  out.u64(static_cast<uint64_t>(slots_.numOpen()));
  for (int32_t k = 0; k < slots_.end(); ++k) {
    if (!slots_.isOpen(k)) continue;
    out.i32(k);
    out.i32(number(slots_.id(k)));
    out.i64(slots_.created(k).us);
    out.i32(twin_of_[static_cast<size_t>(k)]);
  }
  size_t bytes = 0;
  for (const LabelledCell& cell : cells_) bytes += kCellBytes + kWordBytes * cell.words.size();
  out.reserve(bytes + (1 << 16));
  out.u64(cells_.size());
  for (const LabelledCell& cell : cells_) {
    for (const int32_t value : {cell.index.x, cell.index.y, cell.index.z, cell.slot, toldSlot(cell)})
      out.i32(value);
    out.u32(std::bit_cast<uint32_t>(cell.certainty));
    out.u32(std::bit_cast<uint32_t>(cell.surprise));
    out.u32(cell.num_draws);
    out.i32(cell.seen_observation);
    out.i64(cell.seen.us);
    out.u64(cell.words.size());
    for (const world::WordCount& w : cell.words) {
      out.i32(w.word);
      out.i32(w.count);
    }
  }
  out.u64(latest_.size());
  for (const int32_t c : latest_) out.i32(c);
  out.u64(surprise_scale_.counts().size());
  for (const int32_t count : surprise_scale_.counts()) out.i32(count);
  return std::move(out).finish();
}

CellLabelModel CellLabelModel::resumed(const CellLabelHyperparameters& hyperparameters,
                                       const std::vector<world::WordGroup>& groups, uint64_t seed,
                                       world::RobotId robot, std::span<const uint8_t> checkpoint,
                                       const std::vector<KnownTopic>& known) {
  CellLabelModel model(hyperparameters, groups, seed, robot);
  check(known, model.counts_.vocabularySize(), hyperparameters.max_topics);
  model.begin(known);
  StateReader in(checkpoint, kLabelModelKind, kLabelModelVersion);
  in.demand(in.u64() == model.identity(),
            "it is of another robot, seed, vocabulary, hyper-parameters or known topics");
  model.observation_ = in.i32();
  model.time_.us = in.i64();
  model.num_visits_ = in.u64();
  const int32_t num_ids = in.i32();
  in.demand(num_ids >= 0 && num_ids <= world::kMaxTopicId + 1, "it has more topics than there are ids");
  const size_t num_open = in.count(20);
  std::vector<TopicSlots::Named> open;
  for (size_t i = 0; i < num_open; ++i) {
    const TopicSlots::Named topic{in.i32(), world::TopicId{in.i32()}, world::Timestamp{in.i64()}};
    in.demand(topic.slot >= (open.empty() ? 0 : open.back().slot + 1) && topic.slot < model.slots_.size() &&
                  number(topic.id) >= 0 && number(topic.id) < num_ids,
              "its topics are out of order or range");
    open.push_back(topic);
    const int32_t twin = in.i32();
    in.demand(twin == topic.slot ||
                  (twin >= 0 && twin < topic.slot && model.twin_of_[static_cast<size_t>(twin)] == twin &&
                   std::ranges::find(open, twin, &TopicSlots::Named::slot) != open.end()),
              "a topic is a twin of none");
    model.twin_of_[static_cast<size_t>(topic.slot)] = twin;
  }
  for (const TopicSlots::Named& topic : namesOf(known)) {
    const auto kept = std::ranges::find(open, topic.slot, &TopicSlots::Named::slot);
    in.demand(kept != open.end() && kept->id == topic.id, "a known topic is missing");
  }
  model.slots_.restore(num_ids, open);
  std::vector<int64_t> total(static_cast<size_t>(model.counts_.vocabularySize()));  // of each word
  for (const KnownTopic& topic : known)
    for (const world::WordCount& w : topic.words) total[static_cast<size_t>(w.word)] += w.count;
  const size_t num_cells = in.count(kCellBytes);
  for (size_t i = 0; i < num_cells; ++i) {
    world::CellIndex index;
    for (int32_t* const coordinate : {&index.x, &index.y, &index.z}) *coordinate = in.i32();
    in.demand(model.cellFor(index) == static_cast<int32_t>(i), "a cell is there twice");
    LabelledCell& cell = model.cells_.back();
    cell.slot = in.i32();
    in.demand(cell.slot >= 0 && cell.slot < model.slots_.size() && model.slots_.isOpen(cell.slot),
              "a cell has no label");
    cell.told = in.i32();
    in.demand(cell.told >= 0 && cell.told < model.slots_.size() && model.slots_.isOpen(cell.told),
              "a cell is told as none");
    cell.told_openings = model.slots_.openings(cell.told);
    cell.certainty = std::bit_cast<float>(in.u32());
    in.demand(cell.certainty >= 0 && cell.certainty <= 1, "a certainty lies outside [0, 1]");
    cell.surprise = std::bit_cast<float>(in.u32());
    in.demand(cell.surprise >= 0 && std::isfinite(cell.surprise), "a surprise is not a number >= 0");
    cell.num_draws = in.u32();
    cell.seen_observation = in.i32();
    cell.seen.us = in.i64();
    const size_t num_words = in.count(kWordBytes);
    in.demand(num_words > 0, "a cell has no words");
    for (size_t w = 0; w < num_words; ++w) {
      const world::WordCount word{in.i32(), in.i32()};
      in.demand(word.word > (cell.words.empty() ? -1 : cell.words.back().word) &&
                    word.word < model.counts_.vocabularySize() && word.count > 0,
                "words are out of order or range");
      in.demand((total[static_cast<size_t>(word.word)] += word.count) <= INT32_MAX,
                "a word is counted too often");
      cell.words.push_back(word);
      cell.num_words += word.count;
    }
    model.counts_.add(cell.words, cell.slot);
    ++model.cells_of_[static_cast<size_t>(cell.slot)];
  }
  for (const TopicSlots::Named& topic : open) {
    in.demand(model.cells_of_[static_cast<size_t>(topic.slot)] > 0, "a topic has no cell");
  }
  const size_t num_latest = in.count(4);
  for (size_t i = 0; i < num_latest; ++i) {
    model.latest_.push_back(in.i32());
    in.demand(model.latest_.back() >= 0 && model.latest_.back() < model.numCells(),
              "a latest cell is unknown");
  }
  std::vector<int32_t> surprises(in.count(4));
  for (int32_t& cells_at_step : surprises) cells_at_step = in.i32();
  in.demand(model.surprise_scale_.restore(std::move(surprises)), "surprises are out of range");
  in.finish();
  return model;
}

}  // namespace shoal::topics
