// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/matches_codec.h"

#include <algorithm>
#include <shoal/matches_t.hpp>
#include <stdexcept>
#include <string>

#include "shoal/wire/cells_coder.h"
#include "shoal/wire/cut.h"
#include "shoal/wire/message.h"

namespace shoal::wire {
namespace {

using mapping::Correspondence;

std::string fault(const MatchesChunk& chunk) {
  if (chunk.num_chunks < 1 || chunk.num_chunks > kMaxChunks) return "1 to 32767 chunks";
  if (chunk.chunk < 0 || chunk.chunk >= chunk.num_chunks) return "chunks are numbered from 0";
  const auto& list = chunk.correspondences;
  for (size_t i = 0; i < list.size(); ++i) {
    if (number(list[i].robot) < 0 || number(list[i].robot) > kMaxRobotNumber)
      return "robot numbers lie in [0, 9999]";
    if (number(list[i].topic) < 0 || number(list[i].topic) > world::kMaxTopicId)
      return "topic ids lie in [0, 9999]";
    if (number(list[i].label) < 0 || number(list[i].label) > kMaxLabel) return "labels lie in [0, 99999999]";
    if (i > 0 &&
        !(std::pair(list[i - 1].robot, list[i - 1].topic) < std::pair(list[i].robot, list[i].topic))) {
      return "the list is not ascending by robot, topic";
    }
  }
  return {};
}

// The labels in use; then per entry: the step to the next robot, the step to the next topic of that robot,
// and which of the labels.
template <typename Coder>
bool codeList(Coder& coder, std::vector<Correspondence>& list) {
  if (list.empty()) return true;
  Palette labels =
      Coder::kReads ? Palette{} : Palette::of(list, [](const auto& c) -> int64_t { return number(c.label); });
  if (!codePalette(coder, kMaxLabel, list.size(), labels.values)) return false;
  BitTree index(static_cast<int>(std::bit_width(labels.values.size() - 1)));
  SmallNumber robot_step;
  SmallNumber topic_step;
  int32_t robot = 0;
  int32_t next_topic = 0;
  for (size_t i = 0; i < list.size(); ++i) {
    if (coder.overrun()) return false;
    Correspondence& entry = list[i];
    const uint32_t skip = robot_step.code(coder, static_cast<uint32_t>(number(entry.robot) - robot));
    if (skip > static_cast<uint32_t>(kMaxRobotNumber - robot)) return false;
    if (skip > 0) next_topic = 0;
    robot += static_cast<int32_t>(skip);
    const uint32_t step = topic_step.code(coder, static_cast<uint32_t>(number(entry.topic) - next_topic));
    if (step > static_cast<uint32_t>(world::kMaxTopicId)) return false;
    const int32_t topic = next_topic + static_cast<int32_t>(step);
    next_topic = topic + 1;
    const uint32_t which = index.code(coder, Coder::kReads ? 0u : static_cast<uint32_t>(labels.indices[i]));
    if (which >= labels.values.size()) return false;
    entry = {world::RobotId{robot}, world::TopicId{topic},
             world::GlobalLabel{static_cast<int32_t>(labels.values[which])}};
  }
  return !coder.overrun();
}

Bytes encodeValid(const MatchesChunk& chunk, int32_t mission, world::Timestamp time) {
  matches_t message{};
  message.utime = time.us;
  message.mission = mission;
  message.map_digest = static_cast<int64_t>(chunk.map_digest);
  message.chunk = static_cast<int16_t>(chunk.chunk);
  message.num_chunks = static_cast<int16_t>(chunk.num_chunks);
  message.correspondences = static_cast<int32_t>(chunk.correspondences.size());
  Encoder encoder;
  auto list = chunk.correspondences;
  SHOAL_DEMAND(codeList(encoder, list));
  return pack(std::move(message), encoder.finish());
}

}  // namespace

std::vector<Bytes> encodeMatches(std::span<const Correspondence> correspondences, uint64_t map_digest,
                                 int32_t mission, world::Timestamp time, size_t max_payload) {
  if (time.us < 0 || time.us > kMaxTimeUs)
    throw std::invalid_argument("matches: time of sending is out of range");
  const auto make = [&](size_t begin, size_t end) {
    const auto run = correspondences.subspan(begin, end - begin);
    return MatchesChunk{map_digest, 0, 1, {run.begin(), run.end()}};
  };
  if (const std::string why = fault(make(0, correspondences.size())); !why.empty()) {
    throw std::invalid_argument("matches: " + why);
  }
  max_payload = std::min(max_payload, kMaxMessageBytes);
  const auto runs =
      cutRuns(correspondences.size(), kMaxCorrespondencesPerChunk, [&](size_t begin, size_t end) {
        return encodeValid(make(begin, end), mission, time).size() <= max_payload;
      });
  if (runs.size() > static_cast<size_t>(kMaxChunks))
    throw std::invalid_argument("matches: above 32767 chunks");
  std::vector<Bytes> messages;
  for (const auto& [begin, end] : runs) {
    MatchesChunk chunk = make(begin, end);
    chunk.chunk = static_cast<int32_t>(messages.size());
    chunk.num_chunks = static_cast<int32_t>(runs.size());
    messages.push_back(encodeValid(chunk, mission, time));
  }
  return messages;
}

Bytes encode(const MatchesChunk& chunk, int32_t mission, world::Timestamp time) {
  if (time.us < 0 || time.us > kMaxTimeUs)
    throw std::invalid_argument("matches: time of sending is out of range");
  if (const std::string why = fault(chunk); !why.empty()) throw std::invalid_argument("matches: " + why);
  return checkedSize(encodeValid(chunk, mission, time), "matches");
}

Result<MatchesChunk> decodeMatches(std::span<const uint8_t> bytes) {
  const auto message = unpack<matches_t>(bytes);
  if (!message) return message.error();
  const matches_t& m = *message;
  if (m.correspondences < 0 || m.correspondences > kMaxCorrespondencesPerChunk) return DecodeError::kBadField;
  MatchesChunk chunk{static_cast<uint64_t>(m.map_digest), m.chunk, m.num_chunks, {}};
  chunk.correspondences.resize(static_cast<size_t>(m.correspondences));
  Decoder decoder(m.payload);
  if (!codeList(decoder, chunk.correspondences)) return DecodeError::kBadPayload;
  if (!fault(chunk).empty()) return DecodeError::kBadField;
  const Bytes again = encodeValid(chunk, m.mission, {m.utime});
  if (!std::equal(again.begin(), again.end(), bytes.begin(), bytes.end())) return DecodeError::kNotCanonical;
  return chunk;
}

}  // namespace shoal::wire
