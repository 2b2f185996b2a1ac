// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <bit>
#include <numeric>

#include "shoal/demand.h"
#include "shoal/wire/limits.h"
#include "shoal/wire/numbers.h"
#include "shoal/wire/payloads.h"

namespace shoal::wire {
namespace {

using mapping::TopicPart;

constexpr size_t kGroupClasses = 4;  // the first three groups and all others learn apart
constexpr int64_t kMaxCount = 0x7fffffff;

// The greatest common divisor of all counts; of none 1.
int64_t unitOf(const TopicPart& topic) {
  int64_t unit = 0;
  for (const world::WordCount& w : topic.words) unit = std::gcd(unit, int64_t{w.count});
  return std::max<int64_t>(unit, 1);
}

template <typename Coder>
bool codeTopic(Coder& coder, TopicPart& topic, int32_t num_words) {
  topic.created.us = static_cast<int64_t>(codeWide(coder, static_cast<uint64_t>(topic.created.us)));
  topic.weight = static_cast<int64_t>(codeWide(coder, static_cast<uint64_t>(topic.weight)));
  topic.group_sizes.resize(coder.direct(topic.group_sizes.size() - 1, 6) + 1);
  int64_t vocabulary = 0;
  for (int32_t& size : topic.group_sizes) {
    const uint64_t read = codeWide(coder, static_cast<uint64_t>(size));
    if (read == 0 || read > kMaxVocabulary || coder.overrun()) return false;
    size = static_cast<int32_t>(read);
    vocabulary += size;
  }
  if (vocabulary > kMaxVocabulary || num_words > vocabulary) return false;

  const auto unit = static_cast<int64_t>(codeWide(coder, static_cast<uint64_t>(unitOf(topic))));
  if (unit < 1 || unit > kMaxCount) return false;

  // Gaps between words, and counts in the light of the count before, per class of group.
  std::array<SmallNumber, kGroupClasses> gaps;
  std::array<std::array<SmallNumber, 4>, kGroupClasses> counts;
  topic.words.resize(static_cast<size_t>(num_words));
  size_t group = 0;
  int64_t group_end = topic.group_sizes[0];
  const auto groupOf = [&](int64_t word) {
    while (word >= group_end) group_end += topic.group_sizes[++group];
    return std::min(group, kGroupClasses - 1);
  };
  int64_t next = 0;  // the least word that may come
  size_t last_count = 0;
  for (world::WordCount& entry : topic.words) {
    if (coder.overrun() || next >= vocabulary) return false;
    const uint32_t gap = gaps[groupOf(next)].code(coder, static_cast<uint32_t>(entry.word - next));
    const int64_t word = next + gap;
    if (word >= vocabulary) return false;
    entry.word = static_cast<int32_t>(word);
    next = word + 1;
    const uint32_t count =
        counts[groupOf(word)][last_count].code(coder, static_cast<uint32_t>(entry.count / unit - 1));
    if (count >= kMaxCount / unit) return false;
    entry.count = static_cast<int32_t>((int64_t{count} + 1) * unit);
    last_count = std::min<size_t>(static_cast<size_t>(std::bit_width(count)), 3);
  }
  return !coder.overrun() && unitOf(topic) == unit;
}

}  // namespace

Bytes encodeTopic(const TopicPart& topic) {
  TopicPart copy = topic;
  Encoder encoder;
  SHOAL_DEMAND(codeTopic(encoder, copy, static_cast<int32_t>(copy.words.size())));
  return encoder.finish();
}

bool decodeTopic(std::span<const uint8_t> payload, int32_t num_words, TopicPart& topic) {
  Decoder decoder(payload);
  return codeTopic(decoder, topic, num_words);
}

}  // namespace shoal::wire
