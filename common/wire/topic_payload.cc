// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <array>
#include <bit>
#include <numeric>

#include "shoal/demand.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/numbers.h"
#include "shoal/wire/part_coder.h"
#include "shoal/wire/payloads.h"

namespace shoal::wire {
namespace {

using mapping::Piece;
using mapping::TopicPart;

constexpr size_t kGroupClasses = 4;  // the first three groups and all others learn apart
constexpr int64_t kMaxCount = 0x7fffffff;

TopicPart& topicOf(Piece& piece) { return std::get<TopicPart>(piece.content); }

// The greatest common divisor of all counts; of none 1.
int64_t unitOf(const TopicPart& topic) {
  int64_t unit = 0;
  for (const world::WordCount& w : topic.words) unit = std::gcd(unit, int64_t{w.count});
  return std::max<int64_t>(unit, 1);
}

// Which topics follow the first, of what versions, with how many words. Reads into `pieces` and `num_words`,
// which hold the first.
template <typename Coder>
bool codeHeaders(Coder& coder, std::vector<Piece>& pieces, std::vector<int32_t>& num_words) {
  SmallNumber more, gap, version;
  PartCoder parts;
  LongNumber words;
  const size_t count = size_t{more.code(coder, static_cast<uint32_t>(pieces.size() - 1))} + 1;
  if (count > kMaxTopicsPerMessage) return false;
  pieces.resize(count,
                Piece{.key = pieces.front().key, .version = pieces.front().version, .content = TopicPart{}});
  num_words.resize(count);
  int64_t all_words = num_words.front();
  for (size_t i = 1; i < count; ++i) {
    const int32_t before = pieces[i - 1].key.index[0];
    Piece& piece = pieces[i];
    const int64_t id =
        int64_t{before} + 1 + gap.code(coder, static_cast<uint32_t>(piece.key.index[0] - before - 1));
    const int32_t was = pieces[i - 1].version.observation;
    const uint32_t step = version.code(coder, zigzag(piece.version.observation - was));
    const int64_t observation = int64_t{was} + unzigzag(step);
    if (id > world::kMaxTopicId || observation < 0 || observation > kMaxCount) return false;
    piece.key.index[0] = static_cast<int32_t>(id);
    piece.version.observation = static_cast<int32_t>(observation);
    if (!parts.code(coder, piece)) return false;
    const uint64_t own_words = words.code(coder, static_cast<uint64_t>(num_words[i]));
    if (own_words > kMaxWordsPerMessage || coder.overrun()) return false;
    num_words[i] = static_cast<int32_t>(own_words);
    all_words += num_words[i];
  }
  return all_words <= int64_t{kMaxWordsPerMessage};
}

// What is counted in topics of one vocabulary, and when they were made. What one topic teaches about gaps and
// counts holds for the next.
class TopicCoder {
 public:
  explicit TopicCoder(std::vector<int32_t> group_sizes, int64_t period)
      : group_sizes_(std::move(group_sizes)),
        vocabulary_(std::accumulate(group_sizes_.begin(), group_sizes_.end(), int64_t{0})),
        period_(period) {}

  template <typename Coder>
  bool code(Coder& coder, TopicPart& topic, int32_t num_words) {
    const uint64_t created = created_.code(coder, static_cast<uint64_t>(topic.created.us / period_));
    if (created > static_cast<uint64_t>(kMaxTimeUs / period_)) return false;
    topic.created.us = static_cast<int64_t>(created) * period_;
    topic.weight = static_cast<int64_t>(weight_.code(coder, static_cast<uint64_t>(topic.weight)));
    const auto unit = static_cast<int64_t>(unit_.code(coder, static_cast<uint64_t>(unitOf(topic))));
    if (unit < 1 || unit > kMaxCount || num_words > vocabulary_) return false;
    topic.group_sizes = group_sizes_;
    return codeWords(coder, topic, num_words, unit) && !coder.overrun() && unitOf(topic) == unit;
  }

 private:
  // Gaps between words, and counts in the light of the count before, per class of group.
  template <typename Coder>
  bool codeWords(Coder& coder, TopicPart& topic, int32_t num_words, int64_t unit) {
    topic.words.resize(static_cast<size_t>(num_words));
    size_t group = 0;
    int64_t group_end = group_sizes_[0];
    const auto groupOf = [&](int64_t word) {
      while (word >= group_end) group_end += group_sizes_[++group];
      return std::min(group, kGroupClasses - 1);
    };
    int64_t next = 0;  // the least word that may come
    size_t last_count = 0;
    for (world::WordCount& entry : topic.words) {
      if (coder.overrun() || next >= vocabulary_) return false;
      const uint32_t gap = gaps_[groupOf(next)].code(coder, static_cast<uint32_t>(entry.word - next));
      const int64_t word = next + gap;
      if (word >= vocabulary_) return false;
      entry.word = static_cast<int32_t>(word);
      next = word + 1;
      const uint32_t count =
          counts_[groupOf(word)][last_count].code(coder, static_cast<uint32_t>(entry.count / unit - 1));
      if (count >= kMaxCount / unit) return false;
      entry.count = static_cast<int32_t>((int64_t{count} + 1) * unit);
      last_count = std::min<size_t>(static_cast<size_t>(std::bit_width(count)), 3);
    }
    return true;
  }

  std::vector<int32_t> group_sizes_;
  int64_t vocabulary_, period_;
  LongNumber created_, weight_, unit_;
  std::array<SmallNumber, kGroupClasses> gaps_;
  std::array<std::array<SmallNumber, 4>, kGroupClasses> counts_;
};

template <typename Coder>
bool codeGroups(Coder& coder, std::vector<int32_t>& group_sizes) {
  group_sizes.resize(coder.direct(group_sizes.size() - 1, 6) + 1);
  int64_t vocabulary = 0;
  for (int32_t& size : group_sizes) {
    const uint64_t read = codeWide(coder, static_cast<uint64_t>(size));
    if (read == 0 || read > kMaxVocabulary || coder.overrun()) return false;
    size = static_cast<int32_t>(read);
    vocabulary += size;
  }
  return vocabulary <= kMaxVocabulary;
}

template <typename Coder>
bool codeTopics(Coder& coder, std::vector<Piece>& pieces, std::vector<int32_t> num_words) {
  if (!codeHeaders(coder, pieces, num_words)) return false;
  if (!codeGroups(coder, topicOf(pieces.front()).group_sizes)) return false;
  int64_t period = 0;  // the greatest common divisor of the times of creation
  for (Piece& piece : pieces) period = std::gcd(period, topicOf(piece).created.us);
  period = static_cast<int64_t>(codeWide(coder, static_cast<uint64_t>(std::max<int64_t>(period, 1))));
  if (period < 1 || period > kMaxTimeUs) return false;
  TopicCoder topics(topicOf(pieces.front()).group_sizes, period);
  for (size_t i = 0; i < pieces.size(); ++i)
    if (!topics.code(coder, topicOf(pieces[i]), num_words[i])) return false;
  return true;
}

}  // namespace

Bytes encodeTopics(std::span<const Piece* const> pieces) {
  std::vector<Piece> copies;
  std::vector<int32_t> num_words;
  for (const Piece* piece : pieces) {
    copies.push_back(*piece);
    num_words.push_back(static_cast<int32_t>(topicOf(copies.back()).words.size()));
  }
  Encoder encoder;
  SHOAL_DEMAND(codeTopics(encoder, copies, std::move(num_words)));
  return encoder.finish();
}

bool decodeTopics(std::span<const uint8_t> payload, int32_t num_words, std::vector<Piece>& pieces) {
  Decoder decoder(payload);
  return codeTopics(decoder, pieces, {num_words});
}

}  // namespace shoal::wire
