// SPDX-License-Identifier: BSD-3-Clause
#include "shoal/wire/heartbeat_codec.h"

#include <algorithm>
#include <cmath>
#include <shoal/heartbeat_t.hpp>
#include <stdexcept>
#include <string>

#include "shoal/wire/message.h"

namespace shoal::wire {
namespace {

// Why a heartbeat may not travel; empty when it may.
std::string fault(const Heartbeat& h) {
  if (h.time.us < 0 || h.time.us > kMaxTimeUs) return "time is out of range";
  if (h.epoch < 0) return "epoch is negative";
  if (h.observation < -1) return "observation is below -1";
  if (static_cast<int>(h.phase) > static_cast<int>(Phase::kListening)) return "phase is none of 0 to 4";
  if (h.num_topics < 0 || h.num_topics > world::kMaxTopicId + 1) return "num_topics lies outside [0, 10000]";
  for (const int64_t count :
       {int64_t{h.num_observations}, int64_t{h.num_cells}, int64_t{h.pid}, h.bytes_sent, int64_t{h.budget},
        int64_t{h.queue_bytes}, int64_t{h.rejected}, int64_t{h.conflicts}}) {
    if (count < 0) return "a count is negative";
  }
  if (!std::isfinite(h.x_m) || !std::isfinite(h.y_m) || !std::isfinite(h.z_m))
    return "position is not finite";
  if (!std::isfinite(h.ms_per_frame) || h.ms_per_frame < 0) return "ms_per_frame is not a duration";
  if (!std::isfinite(h.cell_size_m) || !(h.cell_size_m > 0)) return "cell_size_m is not a length";
  for (const int64_t bytes : h.class_bytes) {
    if (bytes < 0) return "class_bytes is negative";
  }
  if (h.battery_percent < -1 || h.battery_percent > 100) return "battery_percent lies outside [-1, 100]";
  if (h.depth_cm < -1) return "depth_cm is below -1";
  if (h.learnt != 0 && !hasLanded(h.phase)) return "learnt is of robots that have landed";
  if (h.roster.size() > static_cast<size_t>(kMaxRoster)) return "the roster has more than 256 robots";
  int32_t last = -1;
  for (const auto& share : h.roster) {
    if (number(share.robot) <= last || number(share.robot) > kMaxShareNumber)
      return "the roster is not ascending";
    last = number(share.robot);
  }
  return {};
}

// Fixed fields, seven varints of class bytes, no run, battery, depth, what was learnt.
constexpr size_t kMostWithoutRoster = 142 + 7 * 10 + 1 + 1 + 5 + 4;

// Class bytes; then the robots in runs of consecutive numbers, as pairs (numbers left out, length - 1) after
// the count of runs; then their digests; then, when any of the three is
// known, battery and depth, each plus one; then, when it is, what a robot that has landed has learnt.
Bytes payloadOf(const Heartbeat& h, size_t num_shares) {
  Bytes out;
  for (const int64_t bytes : h.class_bytes) putVarint(out, static_cast<uint64_t>(bytes));
  Bytes runs;
  uint64_t num_runs = 0;
  int32_t next = 0;
  for (size_t i = 0; i < num_shares;) {
    const int32_t first = number(h.roster[i].robot);
    size_t end = i + 1;
    while (end < num_shares && number(h.roster[end].robot) == first + static_cast<int32_t>(end - i)) ++end;
    putVarint(runs, static_cast<uint64_t>(first - next));
    putVarint(runs, end - i - 1);
    next = first + static_cast<int32_t>(end - i);
    ++num_runs;
    i = end;
  }
  putVarint(out, num_runs);
  out.insert(out.end(), runs.begin(), runs.end());
  for (size_t i = 0; i < num_shares; ++i) putBigEndian(out, h.roster[i].digest, 4);
  if (h.battery_percent >= 0 || h.depth_cm >= 0 || h.learnt != 0) {
    putVarint(out, static_cast<uint64_t>(h.battery_percent + 1));
    putVarint(out, static_cast<uint64_t>(int64_t{h.depth_cm} + 1));
  }
  if (h.learnt != 0) putBigEndian(out, h.learnt, 4);
  return out;
}

bool readPayload(std::span<const uint8_t> payload, Heartbeat& h) {
  ByteReader reader(payload);
  for (int64_t& bytes : h.class_bytes) bytes = static_cast<int64_t>(reader.varint());
  uint64_t next = 0;
  for (uint64_t runs = reader.varint(); runs > 0 && !reader.failed(); --runs) {
    const uint64_t first = next + std::min<uint64_t>(reader.varint(), kMaxShareNumber + 1);
    const uint64_t length = std::min<uint64_t>(reader.varint(), kMaxRoster) + 1;
    if (first + length > kMaxShareNumber + 1 || h.roster.size() + length > kMaxRoster) return false;
    for (uint64_t i = 0; i < length; ++i)
      h.roster.push_back({world::RobotId{static_cast<int32_t>(first + i)}, 0});
    next = first + length;
  }
  for (auto& share : h.roster) share.digest = static_cast<uint32_t>(reader.bigEndian(4));
  if (!reader.failed() && reader.remaining() > 0) {
    const uint64_t battery = reader.varint(), depth = reader.varint();
    if (battery > 101 || depth > uint64_t{INT32_MAX} + 1) return false;
    h.battery_percent = static_cast<int32_t>(battery) - 1;
    h.depth_cm = static_cast<int32_t>(static_cast<int64_t>(depth) - 1);
    if (!reader.failed() && reader.remaining() > 0) h.learnt = static_cast<uint32_t>(reader.bigEndian(4));
  }
  return !reader.failed();
}

Bytes encodeValid(const Heartbeat& h, size_t num_shares) {
  heartbeat_t m{};
  m.utime = h.time.us;
  m.mission = h.mission;
  m.phase = static_cast<uint8_t>(h.phase);
  m.epoch = h.epoch;
  m.observation = h.observation;
  m.num_observations = h.num_observations;
  m.num_topics = static_cast<int16_t>(h.num_topics);
  m.num_cells = h.num_cells;
  m.own_digest = static_cast<int64_t>(h.own_digest);
  m.state_digest = static_cast<int64_t>(h.state_digest);
  m.map_digest = static_cast<int64_t>(h.map_digest);
  m.map_of_state = static_cast<int64_t>(h.map_of_state);
  m.vocabulary = static_cast<int64_t>(h.vocabulary);
  m.cell_size_m = h.cell_size_m;
  m.host = h.host;
  m.pid = h.pid;
  m.x_m = h.x_m;
  m.y_m = h.y_m;
  m.z_m = h.z_m;
  m.bytes_sent = h.bytes_sent;
  m.budget = h.budget;
  m.queue_bytes = h.queue_bytes;
  m.rejected = h.rejected;
  m.conflicts = h.conflicts;
  m.ms_per_frame = h.ms_per_frame;
  return pack(std::move(m), payloadOf(h, num_shares));
}

}  // namespace

Bytes encode(const Heartbeat& h, size_t max_payload) {
  if (const std::string why = fault(h); !why.empty()) throw std::invalid_argument("heartbeat: " + why);
  max_payload = std::min(max_payload, kMaxMessageBytes);
  if (max_payload < kMostWithoutRoster) {
    throw std::invalid_argument("heartbeat: needs " + std::to_string(kMostWithoutRoster) +
                                " bytes, allowed are " + std::to_string(max_payload));
  }
  for (size_t num_shares = h.roster.size();; --num_shares) {
    Bytes bytes = encodeValid(h, num_shares);
    if (bytes.size() <= max_payload) return bytes;
  }
}

Result<Heartbeat> decodeHeartbeat(std::span<const uint8_t> bytes) {
  const auto message = unpack<heartbeat_t>(bytes);
  if (!message) return message.error();
  const heartbeat_t& m = *message;
  Heartbeat h;
  h.time.us = m.utime;
  h.mission = m.mission;
  h.phase = static_cast<Phase>(m.phase);
  h.epoch = m.epoch;
  h.observation = m.observation;
  h.num_observations = m.num_observations;
  h.num_topics = m.num_topics;
  h.num_cells = m.num_cells;
  h.own_digest = static_cast<uint64_t>(m.own_digest);
  h.state_digest = static_cast<uint64_t>(m.state_digest);
  h.map_digest = static_cast<uint64_t>(m.map_digest);
  h.map_of_state = static_cast<uint64_t>(m.map_of_state);
  h.vocabulary = static_cast<uint64_t>(m.vocabulary);
  h.cell_size_m = m.cell_size_m;
  h.host = m.host;
  h.pid = m.pid;
  h.x_m = m.x_m;
  h.y_m = m.y_m;
  h.z_m = m.z_m;
  h.bytes_sent = m.bytes_sent;
  h.budget = m.budget;
  h.queue_bytes = m.queue_bytes;
  h.rejected = m.rejected;
  h.conflicts = m.conflicts;
  h.ms_per_frame = m.ms_per_frame;
  if (!readPayload(m.payload, h)) return DecodeError::kBadPayload;
  if (!fault(h).empty()) return DecodeError::kBadField;
  const Bytes again = encodeValid(h, h.roster.size());
  if (!std::equal(again.begin(), again.end(), bytes.begin(), bytes.end())) return DecodeError::kNotCanonical;
  return h;
}

}  // namespace shoal::wire
