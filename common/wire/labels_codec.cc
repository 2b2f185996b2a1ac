// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/labels_codec.h"

#include <algorithm>
#include <shoal/labels_t.hpp>
#include <stdexcept>
#include <string>

#include "shoal/mapping/label_name.h"
#include "shoal/wire/cut.h"
#include "shoal/wire/message.h"
#include "shoal/wire/numbers.h"

namespace shoal::wire {
namespace {

using mapping::LabelSummary;

std::string fault(const LabelsChunk& chunk) {
  if (chunk.num_chunks < 1 || chunk.num_chunks > kMaxChunks) return "1 to 32767 chunks";
  if (chunk.chunk < 0 || chunk.chunk >= chunk.num_chunks) return "chunks are numbered from 0";
  int32_t last_label = -1;
  for (const LabelSummary& row : chunk.labels) {
    const std::string label = "label " + std::to_string(number(row.label)) + ": ";
    if (number(row.label) <= last_label || number(row.label) > kMaxLabel)
      return label + "not ascending, or above 99999999";
    last_label = number(row.label);
    if (!isName(row.name))
      return label + "the name is not UTF-8 of at most 64 bytes without control characters";
    if (row.cells < 0 || row.cells > kMaxTimeUs) return label + "the number of cells is out of range";
    if (!isTime(row.first_seen)) return label + "first seen is out of range";
    if (row.robots.size() > static_cast<size_t>(kMaxRobotsPerLabel))
      return label + "joins more than 256 robots";
    int32_t last_robot = -1;
    for (const world::RobotId robot : row.robots) {
      if (number(robot) <= last_robot || number(robot) > kMaxRobotNumber)
        return label + "robots are not ascending";
      last_robot = number(robot);
    }
  }
  return {};
}

// Per row: step to the next label, cells, first seen, robots, name.
template <typename Coder>
bool codeRows(Coder& coder, std::vector<LabelSummary>& rows) {
  LongNumber label_step;
  LongNumber cells;
  SmallNumber num_robots;
  SmallNumber robot_step;
  BitTree letter(8);
  int64_t next_label = 0;
  for (LabelSummary& row : rows) {
    if (coder.overrun()) return false;
    const uint64_t step = label_step.code(coder, static_cast<uint64_t>(number(row.label) - next_label));
    if (step > static_cast<uint64_t>(kMaxLabel)) return false;
    next_label += static_cast<int64_t>(step);
    if (next_label > kMaxLabel) return false;
    row.label = world::GlobalLabel{static_cast<int32_t>(next_label++)};
    row.cells = static_cast<int64_t>(cells.code(coder, static_cast<uint64_t>(row.cells)));
    row.first_seen.us = static_cast<int64_t>(codeWide(coder, static_cast<uint64_t>(row.first_seen.us)));
    const uint32_t robots = num_robots.code(coder, static_cast<uint32_t>(row.robots.size()));
    if (robots > static_cast<uint32_t>(kMaxRobotsPerLabel)) return false;
    row.robots.resize(robots);
    int32_t next_robot = 0;
    for (world::RobotId& robot : row.robots) {
      const uint32_t gap = robot_step.code(coder, static_cast<uint32_t>(number(robot) - next_robot));
      if (gap > static_cast<uint32_t>(kMaxRobotNumber) || coder.overrun()) return false;
      robot = world::RobotId{next_robot + static_cast<int32_t>(gap)};
      next_robot = number(robot) + 1;
    }
    const uint64_t length = coder.direct(row.name.size(), 7);
    if (length > kMaxNameBytes) return false;
    row.name.resize(length);
    for (char& c : row.name) c = static_cast<char>(letter.code(coder, static_cast<uint8_t>(c)));
  }
  return !coder.overrun();
}

Bytes encodeValid(const LabelsChunk& chunk, int32_t mission, world::Timestamp time) {
  labels_t message{};
  message.utime = time.us;
  message.mission = mission;
  message.map_digest = static_cast<int64_t>(chunk.map_digest);
  message.chunk = static_cast<int16_t>(chunk.chunk);
  message.num_chunks = static_cast<int16_t>(chunk.num_chunks);
  message.labels = static_cast<int16_t>(chunk.labels.size());
  Encoder encoder;
  auto rows = chunk.labels;
  SHOAL_DEMAND(codeRows(encoder, rows));
  return pack(std::move(message), encoder.finish());
}

}  // namespace

bool isName(std::string_view text) { return mapping::isLabelName(text); }

std::vector<Bytes> encodeLabels(std::span<const LabelSummary> labels, uint64_t map_digest, int32_t mission,
                                world::Timestamp time, size_t max_payload) {
  if (!isTime(time)) throw std::invalid_argument("labels: time of sending is out of range");
  const auto make = [&](size_t begin, size_t end) {
    const auto run = labels.subspan(begin, end - begin);
    return LabelsChunk{map_digest, 0, 1, {run.begin(), run.end()}};
  };
  if (const std::string why = fault(make(0, labels.size())); !why.empty()) {
    throw std::invalid_argument("labels: " + why);
  }
  max_payload = std::min(max_payload, kMaxMessageBytes);
  const auto runs = cutRuns(labels.size(), kMaxLabelsPerChunk, [&](size_t begin, size_t end) {
    return encodeValid(make(begin, end), mission, time).size() <= max_payload;
  });
  if (runs.size() > static_cast<size_t>(kMaxChunks))
    throw std::invalid_argument("labels: above 32767 chunks");
  std::vector<Bytes> messages;
  for (const auto& [begin, end] : runs) {
    LabelsChunk chunk = make(begin, end);
    chunk.chunk = static_cast<int32_t>(messages.size());
    chunk.num_chunks = static_cast<int32_t>(runs.size());
    messages.push_back(encodeValid(chunk, mission, time));
  }
  return messages;
}

Bytes encode(const LabelsChunk& chunk, int32_t mission, world::Timestamp time) {
  if (!isTime(time)) throw std::invalid_argument("labels: time of sending is out of range");
  if (const std::string why = fault(chunk); !why.empty()) throw std::invalid_argument("labels: " + why);
  return checkedSize(encodeValid(chunk, mission, time), "labels");
}

Result<LabelsChunk> decodeLabels(std::span<const uint8_t> bytes) {
  const auto message = unpack<labels_t>(bytes);
  if (!message) return message.error();
  const labels_t& m = *message;
  if (m.labels < 0 || m.labels > kMaxLabelsPerChunk) return DecodeError::kBadField;
  LabelsChunk chunk{static_cast<uint64_t>(m.map_digest), m.chunk, m.num_chunks, {}};
  chunk.labels.resize(static_cast<size_t>(m.labels));
  Decoder decoder(m.payload);
  if (!codeRows(decoder, chunk.labels)) return DecodeError::kBadPayload;
  if (!fault(chunk).empty()) return DecodeError::kBadField;
  const Bytes again = encodeValid(chunk, m.mission, {m.utime});
  if (!std::equal(again.begin(), again.end(), bytes.begin(), bytes.end())) return DecodeError::kNotCanonical;
  return chunk;
}

}  // namespace shoal::wire
