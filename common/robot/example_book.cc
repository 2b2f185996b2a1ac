// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/robot/example_book.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <tuple>

#include "shoal/robot/cell_view.h"
#include "shoal/topics/state_bytes.h"

namespace shoal::robot {
namespace {

constexpr size_t kSpares = 2;
constexpr int32_t kApart = 3;           // cells; nearer ones would show the same again
constexpr int32_t kFirstPatience = 4;   // images before an example may change, doubled with every change
constexpr int32_t kMostDoublings = 24;  // more images than that nobody flies
const std::string kBookKind = "shoalEXB";
constexpr uint32_t kBookVersion = 1;

bool areNear(const world::CellIndex& a, const world::CellIndex& b) {
  return std::abs(a.x - b.x) <= kApart && std::abs(a.y - b.y) <= kApart && std::abs(a.z - b.z) <= kApart;
}

// By an eighth.
bool isClearlyBetter(int32_t score, int32_t held) { return 8 * int64_t{score} > 9 * int64_t{held}; }

std::optional<mapping::BelievedCell> find(const mapping::LocalBelief& belief, const world::CellIndex& cell) {
  const auto found = std::ranges::lower_bound(belief.cells, cell, {}, &mapping::BelievedCell::cell);
  if (found == belief.cells.end() || found->cell != cell) return std::nullopt;
  return *found;
}

}  // namespace

void ExampleBook::look(const world::Observation& observation, const world::WordsInCells& words,
                       const mapping::LocalBelief& belief) {
  look(observation, words, belief, [&](const world::CellIndex& cell) { return find(belief, cell); });
}

void ExampleBook::look(const world::Observation& observation, const world::WordsInCells& words,
                       const mapping::LocalBelief& belief, const CellBelief& believed) {
  const Look look{observation, belief, believed, Typicality(belief)};
  for (const mapping::BelievedTopic& topic : belief.topics) pages_.try_emplace(topic.id);
  for (auto& [topic, page] : pages_) {
    if (std::ranges::binary_search(belief.topics, topic, {}, &mapping::BelievedTopic::id)) {
      rescore(look, topic, page);
      continue;
    }
    for (Slot& slot : page.slots) {  // the topic is gone
      if (slot.picture.rgb.empty()) continue;
      slot.picture = {.cell = slot.picture.cell, .seen = slot.picture.seen, .words = {}, .rgb = {}};
      slot.observation = observation.number;
    }
    page.spares.clear();
  }
  collect(look, words);
  for (auto& [topic, page] : pages_) choose(observation.number, page);
}

// Half of it is certainty; half is lost when the robot thinks otherwise by now.
int32_t ExampleBook::score(const Look& look, const std::vector<world::WordCount>& words,
                           const world::CellIndex& cell, world::TopicId topic) const {
  const int32_t typical = look.typicality.of(words, topic);
  const auto believed = look.believed(cell);
  if (!believed || believed->topic != topic) return typical / 4;
  const auto sure = static_cast<int32_t>(
      std::lround(std::clamp(believed->certainty, 0.f, 1.f) * float{mapping::kCertaintySteps}));
  return static_cast<int32_t>(int64_t{typical} * (mapping::kCertaintySteps + sure) /
                              (2 * mapping::kCertaintySteps));
}

void ExampleBook::rescore(const Look& look, world::TopicId topic, Page& page) const {
  for (Slot& slot : page.slots) {
    slot.picture.score = score(look, slot.picture.words, slot.picture.cell, topic);
  }
  std::erase_if(page.spares, [&](const Picture& spare) {
    const auto believed = look.believed(spare.cell);
    return !believed || believed->topic != topic;
  });
  for (Picture& spare : page.spares) spare.score = score(look, spare.words, spare.cell, topic);
  std::ranges::sort(page.spares, [](const Picture& a, const Picture& b) {
    return std::tuple(-a.score, a.cell) < std::tuple(-b.score, b.cell);
  });
}

// The best cell of each topic in this image, when it is better than what is kept already.
void ExampleBook::collect(const Look& look, const world::WordsInCells& words) {
  struct Best {
    const world::CellWords* words = nullptr;
    CellView view;
    int32_t score = 0;
  };
  std::map<world::TopicId, Best> best;
  for (const world::CellWords& seen : words.cells) {
    const auto believed = look.believed(seen.cell);
    if (!believed) continue;
    const auto page = pages_.find(believed->topic);
    if (page == pages_.end()) continue;
    Best& held = best[believed->topic];
    const int32_t found = score(look, seen.words, seen.cell, believed->topic);
    if (found <= held.score) continue;
    // What is shown already, from another side and no better, would only keep others out.
    const bool is_shown = std::ranges::any_of(page->second.slots, [&](const Slot& slot) {
      return !slot.picture.rgb.empty() && areNear(slot.picture.cell, seen.cell) &&
             !isClearlyBetter(found, slot.picture.score);
    });
    if (is_shown) continue;
    const auto view = viewOf(look.observation, seen.cell, grid_);
    if (view) held = {&seen, *view, found};
  }
  for (const auto& [topic, candidate] : best) {
    if (candidate.words == nullptr) continue;
    std::vector<Picture>& spares = pages_.at(topic).spares;
    const world::CellIndex& cell = candidate.words->cell;
    const auto rival = std::ranges::find_if(spares, [&](const Picture& p) { return areNear(p.cell, cell); });
    if (rival != spares.end()) {
      if (rival->score >= candidate.score) continue;
      spares.erase(rival);
    } else if (spares.size() == kSpares) {
      if (spares.back().score >= candidate.score) continue;
      spares.pop_back();
    }
    const auto place =
        std::ranges::find_if(spares, [&](const Picture& p) { return p.score < candidate.score; });
    spares.insert(place, {.cell = cell,
                          .seen = look.observation.time,
                          .words = candidate.words->words,
                          .rgb = cutOut(look.observation, candidate.view, mapping::ExamplePicture::kEdge),
                          .score = candidate.score});
  }
}

void ExampleBook::choose(int32_t observation, Page& page) const {
  for (Slot& slot : page.slots) {
    const auto better = std::ranges::find_if(page.spares, [&](const Picture& spare) {
      return std::ranges::none_of(page.slots, [&](const Slot& other) {
        return &other != &slot && !other.picture.rgb.empty() && areNear(other.picture.cell, spare.cell);
      });
    });
    if (better == page.spares.end()) continue;
    if (!slot.picture.rgb.empty()) {
      const int32_t patience = kFirstPatience << std::min(slot.changes - 1, kMostDoublings);
      if (observation < slot.observation + patience) continue;
      if (!isClearlyBetter(better->score, slot.picture.score)) continue;
    }
    slot.picture = std::move(*better);
    page.spares.erase(better);
    slot.observation = observation;
    ++slot.changes;
  }
}

std::vector<mapping::ExamplePicture> ExampleBook::examples() const {
  std::vector<mapping::ExamplePicture> examples;
  for (const auto& [topic, page] : pages_) {
    for (size_t i = 0; i < page.slots.size(); ++i) {
      const Slot& slot = page.slots[i];
      if (slot.changes == 0) continue;
      examples.push_back({.topic = topic,
                          .number = static_cast<int32_t>(i),
                          .observation = slot.observation,
                          .cell = slot.picture.cell,
                          .seen = slot.picture.seen,
                          .rgb = slot.picture.rgb});
    }
  }
  return examples;
}

namespace {

template <typename Picture>
void put(topics::StateWriter& out, const Picture& picture) {
  for (const int32_t i : {picture.cell.x, picture.cell.y, picture.cell.z}) out.i32(i);
  out.i64(picture.seen.us);
  out.u64(picture.words.size());
  for (const auto& [word, count] : picture.words) {
    out.i32(word);
    out.i32(count);
  }
  out.bytes(picture.rgb);
}

template <typename Picture>
Picture get(topics::StateReader& in, int32_t vocabulary) {
  Picture picture;
  picture.cell = {in.i32(), in.i32(), in.i32()};
  picture.seen = {in.i64()};
  picture.words.resize(in.count(8));
  for (auto& [word, count] : picture.words) {
    word = in.i32();
    count = in.i32();
    in.demand(word >= 0 && word < vocabulary && count > 0, "a word of a picture is out of range");
  }
  const auto rgb = in.bytes();
  constexpr size_t kBytes = size_t{3} * mapping::ExamplePicture::kEdge * mapping::ExamplePicture::kEdge;
  in.demand(rgb.empty() || rgb.size() == kBytes, "a picture has another size");
  picture.rgb.assign(rgb.begin(), rgb.end());
  return picture;
}

}  // namespace

std::vector<uint8_t> ExampleBook::checkpoint() const {
  topics::StateWriter out(kBookKind, kBookVersion);
  out.u64(pages_.size());
  for (const auto& [topic, page] : pages_) {
    out.i32(number(topic));
    for (const Slot& slot : page.slots) {
      put(out, slot.picture);
      out.i32(slot.observation);
      out.i32(slot.changes);
    }
    out.u64(page.spares.size());
    for (const Picture& spare : page.spares) put(out, spare);
  }
  return std::move(out).finish();
}

void ExampleBook::restore(std::span<const uint8_t> checkpoint, int32_t vocabulary) {
  topics::StateReader in(checkpoint, kBookKind, kBookVersion);
  std::map<world::TopicId, Page> pages;
  for (size_t left = in.count(8); left > 0; --left) {
    const int32_t topic = in.i32();
    in.demand(topic >= 0 && topic <= world::kMaxTopicId, "a topic id is out of range");
    Page& page = pages[world::TopicId{topic}];
    for (Slot& slot : page.slots) {
      slot.picture = get<Picture>(in, vocabulary);
      slot.observation = in.i32();
      slot.changes = in.i32();
      in.demand(slot.changes >= 0 && slot.observation >= 0, "a count of a picture is out of range");
    }
    page.spares.clear();
    for (size_t spares = in.count(8); spares > 0; --spares)
      page.spares.push_back(get<Picture>(in, vocabulary));
  }
  in.finish();
  pages_ = std::move(pages);
}

}  // namespace shoal::robot
