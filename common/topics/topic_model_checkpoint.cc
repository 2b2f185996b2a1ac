// SPDX-License-Identifier: BSD-3-Clause
// TopicModel's state to bytes and back. What follows from the rest is left out: counts follow from words and
// their topics, neighbours from cells in order.
#include <bit>
#include <cmath>
#include <utility>

#include "shoal/topics/make_learner.h"
#include "shoal/topics/state_bytes.h"
#include "shoal/topics/topic_model.h"

namespace shoal::topics {
namespace {

const std::string kTopicModelKind = "shoalTPM";
constexpr uint32_t kTopicModelVersion = 3;

}  // namespace

// What a model is made with: a checkpoint of another is none.
uint64_t TopicModel::identity() const {
  uint64_t hash = hashCombine(fingerprint(hyperparameters_), seed_);
  hash = hashCombine(hash, robot_);
  return hashCombine(hashCombine(hash, static_cast<uint64_t>(gibbs_.vocabularySize())), known_hash_);
}

std::vector<uint8_t> TopicModel::checkpoint() const {
  const TopicSlots& slots = gibbs_.slots();
  StateWriter out(kTopicModelKind, kTopicModelVersion);
  out.u64(identity());
  out.i32(observation_);
  out.i64(time_.us);
  out.u64(num_visits_);
  out.i64(num_resamples_);
  out.i64(overrun_);
  out.i32(slots.numIdsUsed());
  out.u64(static_cast<uint64_t>(slots.numOpen()));
  for (int32_t k = 0; k < slots.end(); ++k) {
    if (!slots.isOpen(k)) continue;
    out.i32(k);
    out.i32(number(slots.id(k)));
    out.i64(slots.created(k).us);
  }
  out.u64(cells_.size());
  for (const Cell& cell : cells_) {
    for (const int32_t value : {cell.index.x, cell.index.y, cell.index.z}) out.i32(value);
    out.u32(cell.num_draws);
    out.u32(std::bit_cast<uint32_t>(cell.surprise));
    out.i32(cell.seen_observation);
    out.i64(cell.seen.us);
    out.u64(cell.tokens.size());
    for (const Token& token : cell.tokens) out.i32(token.word * gibbs_.stride() + token.slot);
  }
  out.u64(latest_.size());
  for (const int32_t c : latest_) out.i32(c);
  out.u64(adopted_.size());
  for (const Adopted& topic : adopted_) {
    out.i32(topic.slot);
    out.u64(topic.words.size());
    for (const world::WordCount& w : topic.words) {
      out.i32(w.word);
      out.i32(w.count);
    }
  }
  out.u64(surprise_scale_.counts().size());
  for (const int32_t count : surprise_scale_.counts()) out.i32(count);
  return std::move(out).finish();
}

TopicModel TopicModel::resumed(const Hyperparameters& hyperparameters, int32_t vocabulary_size, uint64_t seed,
                               world::RobotId robot, std::span<const uint8_t> checkpoint,
                               const std::vector<KnownTopic>& known) {
  TopicModel model(hyperparameters, vocabulary_size, seed, robot);  // what it knew is among what was adopted
  model.known_hash_ = hashOf(known);
  const TopicSlots& slots = model.gibbs_.slots();
  StateReader in(checkpoint, kTopicModelKind, kTopicModelVersion);
  in.demand(in.u64() == model.identity(),
            "it is of another robot, seed, vocabulary, hyper-parameters or known topics");
  model.observation_ = in.i32();
  model.time_.us = in.i64();
  model.num_visits_ = in.u64();
  model.num_resamples_ = in.i64();
  model.overrun_ = in.i64();
  in.demand(model.num_resamples_ >= 0 && model.overrun_ >= 0 && model.overrun_ <= model.num_resamples_,
            "its counts of re-samples are out of range");
  const int32_t num_ids = in.i32();
  in.demand(num_ids >= 0 && num_ids <= world::kMaxTopicId + 1, "it has more topics than there are ids");
  const size_t num_open = in.count(16);
  std::vector<TopicSlots::Named> open;
  for (size_t i = 0; i < num_open; ++i) {
    const TopicSlots::Named topic{in.i32(), world::TopicId{in.i32()}, world::Timestamp{in.i64()}};
    in.demand(topic.slot >= (open.empty() ? 0 : open.back().slot + 1) && topic.slot < slots.size() &&
                  number(topic.id) >= 0 && number(topic.id) < num_ids,
              "its topics are out of order or range");
    open.push_back(topic);
  }
  model.gibbs_.restoreTopics(num_ids, open);
  const auto holds = [&](int32_t slot) { return slot >= 0 && slot < slots.size() && slots.isOpen(slot); };
  // Far below what would overflow the counts of any topic.
  int64_t left = int64_t{INT32_MAX};
  const auto count = [&](int32_t slot, std::span<const world::WordCount> words) {
    for (const world::WordCount& w : words) in.demand((left -= w.count) >= 0, "it has too many words");
    model.gibbs_.addCounts(slot, words, 1);
  };

  const size_t num_cells = in.count(44);
  for (size_t i = 0; i < num_cells; ++i) {
    world::CellIndex index;
    for (int32_t* const coordinate : {&index.x, &index.y, &index.z}) *coordinate = in.i32();
    const int32_t c = model.cellFor(index);
    in.demand(c == static_cast<int32_t>(i), "a cell is there twice");
    Cell& cell = model.cells_.back();
    cell.num_draws = in.u32();
    cell.surprise = std::bit_cast<float>(in.u32());
    in.demand(cell.surprise >= 0 && std::isfinite(cell.surprise), "a surprise is not a number >= 0");
    cell.seen_observation = in.i32();
    cell.seen.us = in.i64();
    const size_t num_tokens = in.count(4);
    in.demand(num_tokens > 0, "a cell has no words");
    for (size_t t = 0; t < num_tokens; ++t) {
      const int32_t packed = in.i32();
      in.demand(packed >= 0, "a word is out of range");
      const Token token{packed / model.gibbs_.stride(), packed % model.gibbs_.stride()};
      in.demand(token.word < vocabulary_size && holds(token.slot), "a word has no topic");
      cell.tokens.push_back(token);
      ++model.countsOf(c)[static_cast<size_t>(token.slot)];
      const world::WordCount one{token.word, 1};
      count(token.slot, std::span(&one, 1));
    }
  }
  const size_t num_latest = in.count(4);
  for (size_t i = 0; i < num_latest; ++i) {
    model.latest_.push_back(in.i32());
    in.demand(model.latest_.back() >= 0 && model.latest_.back() < model.numCells(),
              "a latest cell is unknown");
  }
  const size_t num_adopted = in.count(12);
  for (size_t i = 0; i < num_adopted; ++i) {
    Adopted topic{in.i32(), {}};
    in.demand(holds(topic.slot), "an adopted topic has no place");
    const size_t num_words = in.count(8);
    for (size_t w = 0; w < num_words; ++w) {
      const world::WordCount word{in.i32(), in.i32()};
      in.demand(word.word > (topic.words.empty() ? -1 : topic.words.back().word) &&
                    word.word < vocabulary_size && word.count > 0,
                "words of an adopted topic are out of order or range");
      topic.words.push_back(word);
    }
    count(topic.slot, topic.words);
    model.adopted_.push_back(std::move(topic));
  }
  std::vector<int32_t> surprises(in.count(4));
  for (int32_t& cells_at_step : surprises) cells_at_step = in.i32();
  in.demand(model.surprise_scale_.restore(std::move(surprises)), "surprises are out of range");
  for (const TopicSlots::Named& topic : open) {
    in.demand(model.gibbs_.topicCount(topic.slot) > 0, "a topic has no words");
  }
  in.finish();
  return model;
}

}  // namespace shoal::topics
