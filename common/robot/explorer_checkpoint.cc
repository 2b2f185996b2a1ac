// SPDX-License-Identifier: BSD-3-Clause
// An explorer's state to bytes and back. The learner's own checkpoint says which robot, seed, vocabulary and
// hyper-parameters it is of; cell size and word extraction are in the explorer's fingerprint.
#include <stdexcept>
#include <utility>

#include "shoal/robot/explorer.h"
#include "shoal/topics/state_bytes.h"

namespace shoal::robot {
namespace {

const std::string kKind = "shoalEXP";
constexpr uint32_t kVersion = 3;

}  // namespace

std::vector<uint8_t> Explorer::checkpoint() const {
  topics::StateWriter out(kKind, kVersion);
  out.u64(fingerprint());
  out.i32(last_observation_);
  out.u32(looked_again_ ? 1 : 0);
  out.i64(dropped_words_);
  const std::vector<int64_t> camera = words_->learnt();
  out.u64(camera.size());
  for (const int64_t number : camera) out.i64(number);
  const std::vector<uint8_t> learner = learner_->checkpoint();
  out.reserve(learner.size() + (1 << 20));
  out.bytes(learner);
  out.bytes(book_ ? book_->checkpoint() : std::vector<uint8_t>{});
  return std::move(out).finish();
}

void Explorer::restore(std::span<const uint8_t> checkpoint) {
  topics::StateReader in(checkpoint, kKind, kVersion);
  in.demand(in.u64() == fingerprint(), "it is of another profile, cell size, vocabulary or hyper-parameters");
  const int32_t last_observation = in.i32();
  const uint32_t looked_again = in.u32();
  const int64_t dropped_words = in.i64();
  in.demand(last_observation >= -1 && dropped_words >= 0 && looked_again <= 1, "its counts are out of range");
  std::vector<int64_t> camera(in.count(8));
  for (int64_t& number : camera) number = in.i64();
  auto learner = topics::resumeLearner(hyperparameters_, words_->groups(), options_.seed, options_.robot,
                                       in.bytes(), options_.known);
  std::optional<ExampleBook> book;
  if (const auto pictures = in.bytes(); book_) {
    book.emplace(options_.cell_size_m);
    book->restore(pictures, words_->vocabularySize());
  }
  in.finish();
  try {
    words_->resume(camera);
  } catch (const std::invalid_argument& error) {
    in.demand(false, error.what());
  }
  learner_ = std::move(learner);
  book_ = std::move(book);
  bricks_.clear();
  for (const topics::CellLabel& c : learner_->snapshot().cells) note(c.cell);
  seen_bricks_.clear();
  last_observation_ = last_observation;
  looked_again_ = looked_again == 1;
  dropped_words_ = dropped_words;
}

}  // namespace shoal::robot
